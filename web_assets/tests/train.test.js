import assert from "node:assert/strict";
import { test } from "node:test";

import { range } from "../js/loss.js";
import { fitName, progress, untrained } from "../js/train.js";

/** What the line looks at of a training. @type {any} */
const JOB = { status: "running", why: "", name: "mine", states: {}, left_out: {} };

test("one line says how a training goes", () => {
  assert.equal(progress(JOB), "reading takes …");
  const states = {
    stand: { curve: [], step: 30, steps: 60 },
    walk: { curve: [], step: 0, steps: 60 },
    sit: { curve: [] },
  };
  assert.equal(progress({ ...JOB, states }), "stand 50 % · walk 0 %");
  assert.equal(progress({ ...JOB, status: "failed", why: "too few pairs" }), "Too few pairs");
  assert.equal(progress({ ...JOB, status: "cancelled" }), "Cancelled");
  assert.equal(progress({ ...JOB, states, status: "done" }), "Trained mine: stand, walk, sit");
});

test("states that are not trained are named, with what they want", () => {
  const left_out = { walk: "no take shows it", sit: "no take shows it" };
  assert.equal(untrained(left_out), "walk, sit not trained: no take shows it");
  assert.equal(
    untrained({ walk: "no take shows it", sit: "9 pairs" }),
    "walk not trained: no take shows it · sit not trained: 9 pairs",
  );
  const states = { stand: { curve: [], step: 60, steps: 60 } };
  assert.equal(
    progress({ ...JOB, states, left_out, status: "done" }),
    "Trained mine: stand · walk, sit not trained: no take shows it",
  );
  assert.equal(
    progress({ ...JOB, states, left_out }),
    "stand 100 % · walk, sit not trained: no take shows it",
  );
});

test("a mapper's name keeps only what a name may hold", () => {
  assert.equal(fitName("  ada's 2nd, try "), "ada-s-2nd-try");
  assert.equal(fitName(" "), "");
});

test("the loss's scale holds every curve, on powers of ten", () => {
  const curve = /** @type {[number, number][]} */ ([
    [0, 0.1],
    [10, 0.001],
  ]);
  const { low, high } = range({ stand: { curve }, walk: { curve: [[0, 0]] } });
  assert.ok(Math.abs(high - (-1 + 0.05)) < 1e-12);
  assert.ok(Math.abs(low - (-6 - 0.05)) < 1e-12); // nothing is drawn below 1e-6
});
