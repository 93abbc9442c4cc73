import assert from "node:assert/strict";
import { test } from "node:test";

import { coached, passed } from "../js/coached.js";
import { Ticks, about } from "../js/collected.js";
import { itemsOf } from "../js/plan.js";

/** What the coach looks at. @type {any} */
const MOTION = { task: "sit_tilt", state: "sit", prompt: "Lean", done: 1, total: 3, kept: ["a"] };

test("a plan holds the tasks asked for, in their order", () => {
  const tasks = ["tilt", "walk", "sit"].map((task) => /** @type {any} */ ({ task }));
  const counts = new Map([
    ["sit", 1],
    ["tilt", 2],
    ["walk", 0],
  ]);
  assert.deepEqual(itemsOf(tasks, counts, 4), [
    { task: "tilt", takes: 2, seconds: 4 },
    { task: "sit", takes: 1, seconds: 4 },
  ]);
});

test("the coach says what to do in each phase", () => {
  const say = (phase) => coached({ ...MOTION, phase });
  assert.equal(say("ready").task, "Sit tilt");
  assert.equal(say("ready").of, "take 2 of 3");
  assert.equal(say("ready").prompt, "Lean. Sit quietly until it moves.");
  const walk = { ...MOTION, state: "walk", phase: "countdown" };
  assert.equal(coached(walk).prompt, "Lean. Stand quietly until it moves.");
  assert.equal(say("record").prompt, "Lean");
  assert.deepEqual(say("done"), {
    task: "1 take kept",
    of: "",
    prompt: "Review them below, or train a mapper of your own.",
  });
  /** @type {any} */
  const before = { phase: "setup", done: 0, total: 0, kept: [] };
  const words = { task: "", of: "", prompt: "Choose tasks on the right, then Begin." };
  assert.deepEqual(coached(before), words);
});

test("the meter shows how much of a phase has passed, where it passes by itself", () => {
  assert.equal(passed({ phase: "record", t: 2, remaining: 6 }), 0.25);
  assert.equal(passed({ phase: "countdown", t: 0, remaining: 0 }), 0);
  assert.equal(passed({ phase: "review", t: 1, remaining: 3 }), 0.25);
  assert.equal(passed({ phase: "review", t: 1, remaining: null }), null);
  assert.equal(passed({ phase: "ready", t: 1, remaining: 3 }), null);
});

test("kept takes are ticked, until somebody says otherwise or the verdict changes", () => {
  const ticks = new Ticks();
  const take = { name: "a", kept: true };
  assert.ok(ticks.has(take));
  ticks.set(take, false);
  assert.ok(!ticks.has(take));
  assert.ok(!ticks.has({ ...take, kept: false }));
  ticks.set({ ...take, kept: null }, true);
  assert.ok(ticks.has({ ...take, kept: null }));
  assert.ok(ticks.has(take), "a new verdict counts again");
});

test("a take's row says how long it is after its trim, its lag, and that it was recovered", () => {
  /** @type {any} */
  const take = { trim: null, seconds: 9, lag: null, recovered: false };
  assert.equal(about(take), "9.0 s");
  assert.equal(
    about({ ...take, trim: [1, 3.5], lag: 0.25, recovered: true }),
    "2.5 s · lag 0.25 s · recovered",
  );
  const damaged = "it ends early";
  assert.equal(about({ ...take, recovered: true, damaged }), "9.0 s · damaged: it ends early");
});
