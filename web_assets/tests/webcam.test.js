import assert from "node:assert/strict";
import test from "node:test";

import { trouble } from "../js/webcam-device.js";
import { Quiet, advice, confidence } from "../js/webcam-framing.js";
import { humanFrame } from "../js/webcam-link.js";

/** Places of the joints that matter, facing the camera: share of the picture; m, y down. */
const PLACES = {
  0: [0.5, 0.15, 0, -0.6],
  11: [0.58, 0.28, 0.19, -0.5],
  12: [0.42, 0.28, -0.19, -0.5],
  23: [0.54, 0.52, 0.1, 0],
  24: [0.46, 0.52, -0.1, 0],
  25: [0.54, 0.7, 0.1, 0.43],
  26: [0.46, 0.7, -0.1, 0.43],
  27: [0.54, 0.9, 0.1, 0.84],
  28: [0.46, 0.9, -0.1, 0.84],
};

/** Somebody who stands upright in the middle of a well-lit picture. @returns {any} */
function standing() {
  const all = Array.from({ length: 33 }, (_, k) => PLACES[k] ?? PLACES[0]);
  return {
    landmarks: all.map(([x, y]) => [x, y, 0, 0.9]),
    world: all.map(([, , x, y]) => [x, y, 0]),
    people: 1,
    light: 120,
    ms: 20,
    t: 1.5,
  };
}

test("who stands well is given no advice", () => assert.equal(advice(standing()), ""));

/** @type {[string, (seen: any) => unknown, string][]} */
const FLAWS = [
  ["a dark room", (s) => (s.light = 10), "Too dark"],
  ["nobody", (s) => (s.landmarks = s.world = null), "Nobody"],
  ["two people", (s) => (s.people = 2), "Two people"],
  ["a head that is cut off", (s) => (s.landmarks[0][1] = -0.02), "Your head"],
  ["knees out of the picture", (s) => (s.landmarks[25][1] = 1.1), "Step back"],
  ["feet that are guessed", (s) => (s.landmarks[28][3] = 0.2), "Your feet"],
  [
    "somebody from the side",
    (s) => ((s.world[11] = [0.05, -0.5, -0.18]), (s.world[12] = [-0.05, -0.5, 0.18])),
    "sideways",
  ],
  ["somebody far away", (s) => s.landmarks.forEach((l) => (l[1] = 0.4 + l[1] / 4)), "closer"],
];
for (const [name, change, words] of FLAWS)
  test(`advice for ${name}`, () => {
    const seen = standing();
    change(seen);
    assert.match(advice(seen), new RegExp(words));
  });

test("who sits is not asked to come closer", () => {
  const seen = standing();
  for (const l of seen.landmarks) l[1] = 0.4 + l[1] / 4;
  for (const k of [27, 28]) seen.world[k][1] = 0.35; // ankles near the hips
  assert.equal(advice(seen), "");
});

test("confidence is the mean of what drives the robot", () => {
  assert.equal(confidence(null), 0);
  assert.ok(Math.abs(confidence(standing().landmarks) - 0.9) < 1e-12);
});

test("the ring fills within a second and a half of quiet, and is emptied by a movement", () => {
  const quiet = new Quiet();
  const { world } = standing();
  const at = (t, here = world) => quiet.push(here, t, true);
  assert.equal(at(10), 0);
  for (let k = 1; k < 15; k++) at(10 + k / 10);
  assert.equal(at(11.5), 1);
  const moved = world.map(([x, y, z], k) => (k === 15 ? [x + 0.2, y, z] : [x, y, z]));
  assert.equal(at(11.6, moved), 0);
  assert.ok(at(11.7) < 1);
  assert.equal(quiet.push(world, 11.8, false), 0); // not all of the person is seen
  assert.equal(quiet.push(null, 11.9, true), 0);
});

test("after a second of nothing the ring begins anew", () => {
  const quiet = new Quiet();
  quiet.push(standing().world, 5, true);
  assert.equal(quiet.push(standing().world, 6.4, true), 0);
});

test("a frame is MediaPipe's world in metres with its visibilities, and its own time", () => {
  const seen = standing();
  seen.world[0] = [0.123456, -1.00004, 0];
  const frame = humanFrame(seen);
  assert.deepEqual(frame.positions[0], [0.1235, -1, 0]);
  assert.deepEqual([frame.t, frame.skeleton, frame.confidence[5]], [1.5, "mediapipe", 0.9]);
  assert.equal(frame.positions.length, 33);
  assert.equal(humanFrame({ ...seen, world: null }), null);
});

test("what a browser throws is said in words that help", () => {
  assert.match(trouble({ name: "NotAllowedError", message: "" }), /allow it/);
  assert.match(trouble({ name: "NotReadableError", message: "" }), /another program/);
  assert.match(trouble({ name: "OddError", message: "odd" }), /odd/);
});
