import assert from "node:assert/strict";
import { test } from "node:test";

import { corners } from "../js/arrow.js";
import { asked } from "../js/placing.js";

test("a press says where, a drag where to look, and a small one nothing", () => {
  assert.deepEqual(asked([1, 2], [1, 2], [0, 0]), { x: 1, y: 2, yaw: null });
  assert.deepEqual(asked([1, 2], [1.05, 2.05], [0, 0]), { x: 1, y: 2, yaw: null });
  assert.deepEqual(asked([1, 2], [1, 1], [0, 0]), { x: 1, y: 2, yaw: -Math.PI / 2 });
});

test("what is over the horizon, or far from the robot, is no floor", () => {
  for (const down of [
    [NaN, NaN],
    [30, 0],
    [Infinity, 0],
  ])
    assert.equal(typeof asked(down, [0, 0], [0, 0]), "string", `${down}`);
  assert.equal(typeof asked([31, 1], [31, 1], [30, 0]), "object"); // by a robot that went far
});

test("an arrow ends at its tip, however short, and is nothing where it has no length", () => {
  for (const long of [4, 17, 200]) {
    const points = corners([10, 20], [10 + long, 20]);
    assert.deepEqual(points[3], [10 + long, 20]);
    assert.ok(points.every(([x]) => x >= 10 - 1e-9 && x <= 10 + long + 1e-9));
    assert.ok(Math.max(...points.map(([, y]) => Math.abs(y - 20))) <= 10);
  }
  assert.deepEqual(corners([1, 1], [1, 1]), []);
  assert.deepEqual(corners([1, 1], [NaN, 1]), []);
});
