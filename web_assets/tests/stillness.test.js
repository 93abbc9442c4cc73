import assert from "node:assert/strict";
import { test } from "node:test";

import { Stillness } from "../js/stillness.js";

const LIVE = { stopped: false };

/** Twenty ticks, 30 a second, of a robot whose k-th has these joints and place; and when. */
const seen = (joint, x = (k) => 0 * k) => {
  const stillness = new Stillness();
  for (let k = 0; k < 20; k += 1) {
    /** @type {any} */
    const robot = { joint_pos: Array(12).fill(joint(k)), base_pos: [x(k), 0, 0.3] };
    stillness.add({ robot }, (1000 * k) / 30);
  }
  return { stillness, now: 19000 / 30 };
};

test("a robot that does not move is still", () => {
  const { stillness, now } = seen(() => 0.8);
  assert.ok(stillness.still(LIVE, now + 50));
});

test("a joint or a step within half a second is movement", () => {
  for (const { stillness, now } of [
    seen((k) => 0.002 * k),
    seen(
      () => 0.8,
      (k) => 0.0005 * k,
    ),
  ])
    assert.ok(!stillness.still(LIVE, now));
});

test("what was longer ago does not count", () => {
  const { stillness, now } = seen((k) => (k < 3 ? 0.5 : 0.8));
  assert.ok(stillness.still(LIVE, now));
});

test("without fresh ticks, or with few, nobody knows", () => {
  const { stillness, now } = seen(() => 0.8);
  assert.ok(!stillness.still(LIVE, now + 400));
  assert.ok(!new Stillness().still(LIVE, 0));
  const few = new Stillness();
  /** @type {any} */
  const robot = { joint_pos: Array(12).fill(0), base_pos: [0, 0, 0.3] };
  few.add({ robot }, 0);
  assert.ok(!few.still(LIVE, 10));
});

test("a robot that is stopped is as still as it needs to be, while it is heard of", () => {
  const { stillness, now } = seen((k) => 0.01 * k);
  assert.ok(stillness.still({ stopped: true }, now));
  assert.ok(!stillness.still({ stopped: true }, now + 400));
});
