import assert from "node:assert/strict";
import { test } from "node:test";

import { horizon } from "../js/eye.js";

test("the horizon sinks where the nose rises, and turns against the trunk", () => {
  const level = horizon([1, 0, 0, 0]);
  assert.ok(Math.abs(level.up) + Math.abs(level.turn) < 1e-12);
  const half = 0.2;
  const up = horizon([Math.cos(half), 0, -Math.sin(half), 0]); // pitch < 0: the nose is up
  assert.ok(up.up < -0.5);
  const right = horizon([Math.cos(half), Math.sin(half), 0, 0]); // it leans to its right
  assert.ok(Math.abs(right.turn + 2 * half) < 1e-9 && Math.abs(right.up) < 1e-9);
  assert.ok(Number.isFinite(horizon([Math.SQRT1_2, 0, Math.SQRT1_2, 0]).up));
});
