import assert from "node:assert/strict";
import { test } from "node:test";

import { captionsOf } from "../js/captions.js";

/** What it looks at of a tick. @type {any} */
const tick = {
  mode: "live",
  state: "walk",
  transition_to: null,
  controller: "pd_playback",
  expert: "walk",
  fallen: false,
  human: {},
};

test("three figures are named for what they are", () => {
  assert.deepEqual(captionsOf(tick, { source: "operator:tilt" }), {
    human: ["Synthetic person", "meaning: walk"],
    reference: ["What it should do", "walk"],
    robot: ["What physics lets it do", "pd playback"],
  });
  const lost = { ...tick, state: "transition", transition_to: "sit", expert: "unknown" };
  assert.deepEqual(captionsOf({ ...lost, fallen: true, human: null }, { source: "stream" }), {
    human: ["You", "nobody seen"],
    reference: ["What it should do", "changing to sit"],
    robot: ["What physics lets it do", "fallen"],
  });
});

test("who the person is depends on where they come from", () => {
  const who = (source, more = {}) => captionsOf({ ...tick, ...more }, { source }).human[0];
  assert.equal(who("operator:interactive"), "Synthetic person");
  assert.equal(who("bvh:/clips/march.bvh"), "Recorded person");
  assert.equal(who("take:mine"), "Recorded person");
  assert.equal(who("webcam"), "You");
  assert.equal(who("operator", { mode: "replay" }), "Recorded person");
});

test("what is shown is not what anybody asked the robot to do", () => {
  const reference = (more) => captionsOf({ ...tick, ...more }, { source: "webcam" }).reference[0];
  assert.equal(reference({ mode: "collect" }), "What to act out");
  assert.equal(reference({ mode: "replay", controller: "recorded" }), "What it was shown");
  assert.equal(reference({ mode: "replay" }), "What it should do");
});

test("at its end a clip or a take is said to have ended, whoever was seen last", () => {
  /** @type {any} */
  const transport = { ended: true };
  const line = (source, human) => captionsOf({ ...tick, human }, { source, transport }).human[1];
  assert.equal(line("bvh:clip.bvh", null), "the clip has ended");
  assert.equal(line("take:one", {}), "the take has ended");
  const reviewed = captionsOf({ ...tick, mode: "replay" }, { source: "bvh:clip.bvh", transport });
  assert.equal(reviewed.human[1], "meaning: walk");
});
