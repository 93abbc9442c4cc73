import assert from "node:assert/strict";
import { test } from "node:test";

import { place, stand } from "../js/cameras.js";

const close = (point, expected) =>
  point.forEach((c, i) => assert.ok(Math.abs(c - expected[i]) < 1e-12, `${point} ${expected}`));

test("a camera of a narrow view steps back along its own direction", () => {
  const wide = stand("side", 2);
  close(wide.eye, [1.1, -3.6, 1.2]);
  close(wide.at, [0, 0, 0.4]);
  close(stand("side", 0.875).eye, [2.2, -7.2, 2]); // half as wide as all three figures need
});

test("a caption stands at its figure, and inside the view", () => {
  const view = [800, 600];
  const caption = [100, 40];
  assert.deepEqual(place({ x: 0, y: 0 }, view, caption), { left: 400, top: 300 });
  assert.deepEqual(place({ x: -1, y: 1 }, view, caption), { left: 56, top: 46 });
  assert.deepEqual(place({ x: 1, y: -1 }, view, caption), { left: 744, top: 530 });
  assert.equal(place({ x: 1.2, y: 0 }, view, caption), null);
  assert.equal(place({ x: 0, y: -1.3 }, view, caption), null);
});
