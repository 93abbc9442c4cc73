import assert from "node:assert/strict";
import { test } from "node:test";

import { bounds } from "../js/scene-map.js";
import { clock, next } from "../js/scenes.js";

/** @import { SceneInfo, State } from "../types/page.js" */

const scene = /** @type {SceneInfo} */ (
  /** @type {unknown} */ ({ steps: [{ body: "march" }, { body: "reach" }] })
);
const steps = [
  { text: "Walk.", done: true, t: 3 },
  { text: "Touch.", done: false, t: null },
];
const progress = /** @type {State["progress"]} */ ({
  name: "x",
  step: 1,
  steps,
  score: 90,
  time_s: 71.9,
  finished: false,
  failed: null,
});

test("what to do next is the step, and what the person does for it", () => {
  assert.deepEqual(next(progress, scene), { title: "2 of 2 · Touch.", body: "reach" });
});

test("a scene that is done or over says so, and what may come", () => {
  const done = next({ ...progress, step: 2, finished: true }, scene);
  assert.equal(done.title, "Done!");
  assert.match(done.body, /90 points in 1:11/);
  assert.match(next({ ...progress, failed: "the robot fell" }, scene).title, /the robot fell/);
});

test("a map holds all that there is, and is no smaller than a room", () => {
  const { middle, side } = bounds([[0, 0], [6, 1]]); // prettier-ignore
  assert.deepEqual(middle, [3, 0.5]);
  assert.ok(side > 6);
  assert.ok(bounds([[1, 1]]).side > 3);
});

test("seconds are told as on a clock", () => {
  assert.equal(clock(0), "0:00");
  assert.equal(clock(125.6), "2:05");
});
