import assert from "node:assert/strict";
import { test } from "node:test";

import { Scale, stretches } from "../js/timeline-paint.js";
import { gripAt, trimmed } from "../js/timeline.js";

test("times and places across the canvas are each other's inverse", () => {
  const scale = new Scale(10, 586); // 500 px beside 74 and 12
  assert.equal(scale.x(0), 74);
  assert.equal(scale.x(10), 574);
  assert.equal(scale.x(5), 324);
  for (const t of [0, 1.25, 9.9]) assert.ok(Math.abs(scale.t(scale.x(t)) - t) < 1e-12);
});

test("a place beside the curves is the take's first or last instant", () => {
  const scale = new Scale(10, 586);
  assert.equal(scale.t(0), 0);
  assert.equal(scale.t(600), 10);
});

test("the ruler's marks are round and far enough apart to be read", () => {
  assert.equal(new Scale(10, 524).gap, 2); // 5 marks fit: 2 s
  assert.equal(new Scale(11, 524).gap, 5);
  assert.equal(new Scale(1, 974).gap, 0.1);
  assert.equal(new Scale(36000, 524).gap, 1200);
});

test("a handle is held near the top, and lower only when hit well", () => {
  const handles = /** @type {[number, number]} */ ([100, 500]);
  assert.equal(gripAt(handles, { x: 107, y: 10 }), 0);
  assert.equal(gripAt(handles, { x: 107, y: 100 }), "seek");
  assert.equal(gripAt(handles, { x: 103, y: 100 }), 0);
  assert.equal(gripAt(handles, { x: 495, y: 10 }), 1);
  assert.equal(gripAt(handles, { x: 300, y: 10 }), "seek");
});

test("a trim's ends never pass each other", () => {
  assert.deepEqual(trimmed([1, 5], 0, 2), [2, 5]);
  assert.deepEqual(trimmed([1, 5], 0, 7), [4.9, 5]);
  assert.deepEqual(trimmed([1, 5], 1, 0), [1, 1.1]);
});

test("each stretch on the floor is found, one that lasts to the end included", () => {
  assert.deepEqual(stretches([]), []);
  assert.deepEqual(stretches([false, true, true, false, true]), [
    [1, 3],
    [4, 4],
  ]);
  assert.deepEqual(stretches([true, true]), [[0, 1]]);
});
