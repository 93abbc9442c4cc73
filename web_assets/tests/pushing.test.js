import assert from "node:assert/strict";
import { test } from "node:test";

import { forceOf } from "../js/pushing.js";
import { meets } from "../js/screen.js";

test("an arrow's force grows with it, up to a limit, and is level", () => {
  assert.deepEqual(forceOf(0, 0), [0, 0, 0]);
  const [x, y, z] = forceOf(0.1, -0.2);
  assert.ok(Math.abs(y + 2 * x) < 1e-9 && x > 0);
  assert.equal(z, 0);
  assert.ok(Math.abs(Math.hypot(...forceOf(30, 40)) - 60) < 1e-9);
});

test("a ray meets the robot's height, or goes far where it would not", () => {
  const [x, y] = meets([3, 0, 1], [2, 0, 0.5], 0.25);
  assert.ok(Math.abs(x - 1.5) < 1e-9 && Math.abs(y) < 1e-9);
  const far = meets([3, 0, 1], [2, 0, 1.2], 0.25, 10); // above the horizon
  assert.ok(meets([3, 0, 1], [2, 0, 1.2], 0.25).every(Number.isNaN));
  assert.ok(far[0] < -5 && Number.isFinite(far[0]));
});
