import assert from "node:assert/strict";
import { test } from "node:test";

import { body, place, placeOf, spread, stand, turnBy, wrapped } from "../js/cameras.js";

const close = (point, expected) =>
  point.forEach((c, i) => assert.ok(Math.abs(c - expected[i]) < 1e-12, `${point} ${expected}`));

test("a camera of a narrow view steps back along its own direction", () => {
  const wide = stand("side", 2);
  close(wide.eye, [0, -4, 1.32]);
  close(wide.at, [0, 0, 0.42]);
  close(stand("side", 0.875).eye, [0, -8, 2.22]); // half as wide as all three figures need
});

/** What a figure takes up, m: half along x and y, and its height. */
const SIZES = { human: [0.3, 0.3, 1.05], reference: [0.36, 0.2, 0.42], robot: [0.36, 0.2, 0.42] };
const COLUMNS = { human: [0, -0.86], reference: [0, 0], robot: [0, 0.82] };

/** The box (left, bottom, right, top) on the screen that holds a figure, in tangents. */
function seen(camera, figure) {
  const { eye, at } = stand(camera, camera === "split" ? 0.875 : 1.75);
  const unit = (v) => v.map((c) => c / Math.hypot(...v));
  const cross = (a, b) => [
    a[1] * b[2] - a[2] * b[1],
    a[2] * b[0] - a[0] * b[2],
    a[0] * b[1] - a[1] * b[0],
  ];
  const dot = (a, b) => a.reduce((sum, c, i) => sum + c * b[i], 0);
  const ahead = unit(at.map((c, i) => c - eye[i]));
  const right = unit(cross(ahead, [0, 0, 1]));
  const up = cross(right, ahead);
  const [x, y] = placeOf(camera, figure) ?? COLUMNS[figure];
  const [a, b, high] = SIZES[figure];
  const points = [-a, a].flatMap((dx) =>
    [-b, b].flatMap((dy) =>
      [0, high].map((z) => {
        const from = [x + dx, y + dy, z].map((c, i) => c - eye[i]);
        return [dot(from, right), dot(from, up)].map((c) => c / dot(from, ahead));
      }),
    ),
  );
  const of = (pick, i) => pick(...points.map((point) => point[i]));
  return [of(Math.min, 0), of(Math.min, 1), of(Math.max, 0), of(Math.max, 1)];
}

for (const camera of /** @type {const} */ (["side", "top", "split", "front"]))
  test(`no figure hides another: ${camera}`, () => {
    const split = camera === "split"; // in which the person has a half of their own
    const figures = Object.keys(SIZES).slice(split ? 1 : 0);
    const boxes = figures.map((figure) => seen(camera, figure));
    const wide = Math.tan(0.25) * (split ? 0.875 : 1.75); // of 0.5 rad, upright
    for (const [i, a] of boxes.entries()) {
      assert.ok(a[0] > -wide && a[2] < wide, `${i} is in sight: ${a}`);
      for (const b of boxes.slice(i + 1))
        assert.ok(a[2] < b[0] || b[2] < a[0] || a[3] < b[1] || b[3] < a[1], `${i}: ${a}; ${b}`);
    }
  });

test("a chasing camera turns with the robot, smoothly, or cuts where no motion is wanted", () => {
  let behind = 0;
  for (let i = 0; i < 60; i += 1) behind += turnBy(wrapped(3 - behind), 1 / 30, false);
  assert.ok(behind > 2.9 && behind < 3);
  assert.ok(turnBy(wrapped(-3 - 3), 1 / 30, false) > 0); // the short way
  assert.equal(turnBy(0.5, 1 / 30, true), 0);
  assert.equal(turnBy(-1, 1 / 30, true), -1);
});

test("a caption stands at its figure, and inside the view", () => {
  const view = { x: 0, y: 0, width: 800, height: 600 };
  const caption = /** @type {[number, number]} */ ([100, 40]);
  assert.deepEqual(place({ x: 0, y: 0 }, view, caption), { left: 400, top: 300 });
  assert.deepEqual(place({ x: -1, y: 1 }, view, caption), { left: 56, top: 46 });
  assert.deepEqual(place({ x: 1, y: -1 }, view, caption), { left: 744, top: 530 });
  const half = { x: 400, y: 0, width: 400, height: 600 };
  assert.deepEqual(place({ x: 0, y: 0 }, half, caption), { left: 600, top: 300 });
  assert.deepEqual(place({ x: -1, y: 1 }, half, caption), { left: 456, top: 46 });
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

test("low views look higher, along the same direction, high ones as ever", () => {
  const [high, low, lower] = [900, 480, 200].map((px) => stand("front", 1.75, false, 0, px));
  assert.deepEqual(stand("front", 1.75), high);
  assert.ok(low.at[2] > high.at[2] + 0.1);
  assert.deepEqual(lower, low);
  close(
    low.eye.map((c, i) => c - low.at[i]),
    high.eye.map((c, i) => c - high.at[i]),
  );
});

test("a caption goes under the feet where there is no room over the head", () => {
  const view = { x: 100, y: 0, width: 800, height: 400 };
  const box = body({ x: 0, y: 0.9 }, { y: -0.5 }, view, true);
  assert.ok(box && box.left < 500 && box.right > 500 && box.top > 20 && box.bottom >= 300);
  const kept = [{ left: 0, top: 0, right: 900, bottom: 50 }, box];
  const size = /** @type {[number, number]} */ ([100, 40]);
  const [at] = spread([{ left: 500, top: 20, size }], kept, 400);
  assert.ok(at.top - 40 >= box.bottom && at.top < 400);
  assert.equal(body({ x: 0, y: 0.1 }, { y: 0.05 }, view, true), null); // from above
  assert.equal(body({ x: 0, y: NaN }, { y: NaN }, view, true), null);
});
