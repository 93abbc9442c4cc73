import assert from "node:assert/strict";
import test from "node:test";

import { SECTIONS, filmLate, percentiles, sections, toReference } from "../js/latency.js";
import { BITS, number } from "../js/timecode.js";

/** @param {number} value */
function cells(value) {
  const bits = Array.from({ length: BITS }, (_, k) => Boolean((value >> (BITS - 1 - k)) & 1));
  return [true, false, ...bits, bits.filter(Boolean).length % 2 === 0, true];
}

test("a number is read from its cells, and none where one of them is covered", () => {
  for (const value of [0, 1, 777, 2730, 4095]) assert.equal(number(cells(value)), value);
  const right = cells(1234);
  for (const k of right.keys()) assert.equal(number(right.with(k, !right[k])), null);
});

const frame = { taken: 100, handed: 104, code: 7, model: 30, sent: 140 };
const tick = /** @type {any} */ ({
  human: { echo: { sent: 0.1, waited_ms: 17 } },
  timings_ms: { inference: 1, physics: 0.5, retarget: 0.7 },
});

test("the sections of a frame's way are all of it", () => {
  const row = sections(frame, tick, 161, 170);
  assert.deepEqual(
    Object.keys(SECTIONS).map((name) => row[/** @type {keyof typeof SECTIONS} */ (name)]),
    [4, 30, 6, 2.5, 17, 1, 0.5, 9],
  );
  assert.equal(row.total, 70);
  assert.equal(toReference(row), 4 + 6 + 2.5 + 17 + 1);
});

test("percentiles are those between the nearest two", () => {
  const row = percentiles(Array.from({ length: 101 }, (_, k) => 100 - k));
  assert.deepEqual(row, { p50: 50, p95: 95, p99: 99 });
  assert.deepEqual(percentiles([3]), { p50: 3, p95: 3, p99: 3 });
  assert.equal(percentiles([1, 2]).p50, 1.5);
});

test("a film's pictures tell how late they come, play by play", () => {
  const rows = [0, 3, 6, 1, 4].map((code, k) => ({
    code,
    handed: (1000 * (code + (k > 2 ? 7 : 0))) / 30 + [5, 5, 25, 5, 15][k],
  }));
  const late = filmLate([...rows, { code: null, handed: 9999 }]).map(Math.round);
  assert.deepEqual(late, [0, 0, 20, 0, 10]);
});
