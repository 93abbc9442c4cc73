import assert from "node:assert/strict";
import { test } from "node:test";

import { healthOf, phaseOf } from "../js/behind.js";
import { captionsOf } from "../js/captions.js";

/** @type {any} */
const LINK = { phase: "following", why: "", heard_s: 0.01, silent: false };

test("a robot behind a link says what it does, why it is limp, and how long it is silent", () => {
  assert.equal(phaseOf(LINK), "following");
  assert.equal(phaseOf({ ...LINK, phase: "halting" }), "comes to a stand");
  assert.equal(phaseOf({ ...LINK, phase: "limp", why: "asked to" }), "limp: stopped");
  assert.equal(phaseOf({ ...LINK, phase: "limp", why: "never heard" }), "limp: never heard");
  assert.equal(phaseOf({ ...LINK, heard_s: 2.34, silent: true }), "silent for 2.3 s");
});

test("it is well while it follows, and on its way while it rises", () => {
  assert.equal(healthOf(LINK), "up");
  assert.equal(healthOf({ ...LINK, phase: "rising" }), "connecting");
  assert.equal(healthOf({ ...LINK, phase: "limp" }), "down");
  assert.equal(healthOf({ ...LINK, silent: true }), "down");
});

test("its figure is called by what it is, but for a take's", () => {
  /** @type {any} */
  const tick = { mode: "live", state: "stand", controller: "policy", human: {}, expert: "stand" };
  assert.deepEqual(captionsOf(tick, { link: LINK }).robot, ["Robot behind a link", "following"]);
  assert.equal(captionsOf({ ...tick, mode: "replay" }, { link: LINK }).robot[1], "policy");
  assert.equal(captionsOf(tick, { link: null }).robot[0], "What physics lets it do");
});
