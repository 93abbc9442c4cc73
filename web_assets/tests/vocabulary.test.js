import assert from "node:assert/strict";
import { test } from "node:test";

import { VOCABULARY, meaningOf } from "../js/vocabulary.js";

const UPRIGHT = { base_pos: [0, 0, 0.3], base_quat: [1, 0, 0, 0], foot_contact: [1, 1, 1, 1] };
/** What it looks at of a tick. @returns {any} */
const tick = (expert, reference = {}) => ({
  human: {},
  expert,
  reference: { ...UPRIGHT, ...reference },
});
/** wxyz of a turn about one axis by `angle` rad. */
const turn = (axis, angle) =>
  [0, 1, 2].reduce(
    (quat, i) => [...quat, i === axis ? Math.sin(angle / 2) : 0],
    [Math.cos(angle / 2)],
  );

test("a tick shows what the person means", () => {
  assert.equal(meaningOf(tick("stand")), "stand");
  assert.equal(meaningOf(tick("stand", { base_pos: [0, 0, 0.2] })), "crouch");
  assert.equal(meaningOf(tick("stand", { foot_contact: [1, 0, 1, 1] })), "reach");
  assert.equal(meaningOf(tick("walk", { foot_contact: [1, 0, 0, 1] })), "walk");
  assert.equal(meaningOf(tick("sit")), "sit");
  assert.equal(meaningOf(tick("unknown")), null);
  assert.equal(meaningOf({ ...tick("stand"), human: null }), null);
});

test("leaning or bending by more than 0.1 rad is a tilt, a turn of the heading is none", () => {
  for (const axis of [0, 1]) {
    assert.equal(meaningOf(tick("stand", { base_quat: turn(axis, 0.11) })), "tilt");
    assert.equal(meaningOf(tick("stand", { base_quat: turn(axis, 0.09) })), "stand");
  }
  assert.equal(meaningOf(tick("stand", { base_quat: turn(2, 1.5) })), "stand");
});

test("every style says how to walk and how to turn, and each meaning has a line", () => {
  const lines = (style) => VOCABULARY.filter((line) => line.style === style).map(({ id }) => id);
  for (const style of ["march", "circles", "semantic"])
    assert.deepEqual(lines(style), ["walk", "turn"]);
  assert.deepEqual(lines(undefined), ["stand", "tilt", "crouch", "sit", "reach"]);
});
