import assert from "node:assert/strict";
import { test } from "node:test";

import { HISTORY, TickHistory } from "../js/history.js";

test("a tick's work is the sum of its sections, without sums of others and waiting", () => {
  const history = new TickHistory();
  history.add({ timings_ms: { physics: 1, policy: 0.5, total: 9, wait: 20, inference: 3 } }, 10);
  assert.deepEqual(history.total, [1.5]);
  assert.deepEqual(
    [...history.sections],
    [
      ["physics", 1],
      ["policy", 0.5],
    ],
  );
  history.add({ timings_ms: { physics: 3, policy: 0.5 } }, 43);
  // 0.95 of what it was and 0.05 of what it is: 0.95 * 1 + 0.05 * 3 = 1.1.
  assert.ok(Math.abs(history.sections.get("physics") - 1.1) < 1e-12);
});

test("percentiles are of the last twenty seconds", () => {
  const history = new TickHistory();
  assert.equal(history.percentile(0.5), 0);
  for (let i = 0; i < HISTORY + 100; i += 1) history.add({ timings_ms: { all: i } }, 0);
  assert.equal(history.total.length, HISTORY);
  assert.equal(history.percentile(0), 100);
  assert.equal(history.percentile(0.5), 400);
  assert.equal(history.percentile(1), 699);
});

test("the rate does not swing when a page that was busy catches up", () => {
  const history = new TickHistory();
  const come = (from, until, now) => {
    for (let i = from; i < until; i += 1) history.add({ timings_ms: {} }, now ?? (i * 1000) / 30);
  };
  assert.equal(history.rate, 0);
  come(1, 16);
  assert.equal(history.rate, 0); // half a second does not tell
  come(16, 181);
  assert.ok(Math.abs(history.rate - 30) < 0.5, `${history.rate}`);
  come(181, 240, 8000); // two seconds' worth at once
  assert.ok(Math.abs(history.rate - 30) < 0.5, `${history.rate}`);
  come(240, 300);
  assert.ok(Math.abs(history.rate - 30) < 0.5, `${history.rate}`);
});
