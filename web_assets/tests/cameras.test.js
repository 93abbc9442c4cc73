import assert from "node:assert/strict";
import { test } from "node:test";

import { place, spread, stand } from "../js/cameras.js";

const close = (point, expected) =>
  point.forEach((c, i) => assert.ok(Math.abs(c - expected[i]) < 1e-12, `${point} ${expected}`));

test("a camera of a narrow view steps back along its own direction", () => {
  const wide = stand("side", 2);
  close(wide.eye, [1.1, -3.6, 1.2]);
  close(wide.at, [0, 0, 0.4]);
  close(stand("side", 0.875).eye, [2.2, -7.2, 2]); // half as wide as all three figures need
});

test("a caption stands at its figure, and inside the view", () => {
  const [view, caption] = /** @type {[number, number][]} */ ([
    [800, 600],
    [100, 40],
  ]);
  assert.deepEqual(place({ x: 0, y: 0 }, view, caption), { left: 400, top: 300 });
  assert.deepEqual(place({ x: -1, y: 1 }, view, caption), { left: 56, top: 46 });
  assert.deepEqual(place({ x: 1, y: -1 }, view, caption), { left: 744, top: 530 });
  assert.equal(place({ x: 1.2, y: 0 }, view, caption), null);
  assert.equal(place({ x: 0, y: -1.3 }, view, caption), null);
  assert.equal(place({ x: NaN, y: NaN }, view, caption), null);
});

test("no caption lies over another, or over what must stay free", () => {
  const size = /** @type {[number, number]} */ ([100, 40]);
  const one = (left, top) => ({ left, top, size });
  const kept = [{ left: 0, top: 0, right: 90, bottom: 50 }];
  const boxes = (captions) =>
    spread(captions, kept, 300).map(({ left, top }) => [left - 50, top - 40, left + 50, top]);
  assert.deepEqual(boxes([one(200, 100)]), [[150, 60, 250, 100]]);
  assert.deepEqual(boxes([one(60, 60)]), [[10, 54, 110, 94]]); // under the button
  for (const captions of [
    [one(200, 100), one(220, 110), one(240, 105)],
    [one(60, 60), one(70, 62), one(80, 300)],
  ]) {
    const all = [...boxes(captions), [0, 0, 90, 50]];
    for (const [i, a] of all.entries())
      for (const b of all.slice(i + 1))
        assert.ok(a[2] <= b[0] || b[2] <= a[0] || a[3] <= b[1] || b[3] <= a[1], `${a} ${b}`);
  }
});
