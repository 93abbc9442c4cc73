import assert from "node:assert/strict";
import { test } from "node:test";

import { became, listed, sessionsOf, space } from "../js/library-list.js";
import { Selection } from "../js/selection.js";

const ORDER = ["a", "b", "c", "d"];
const take = (name, more) => ({ name, label: "", note: "", source: "", seconds: 1, ...more });
const TAKES = [
  take("one", { started: "2026-01-01T10:00", kept: true, score: 0.5, seconds: 9, trim: [1, 2] }),
  take("two", { started: "2026-01-03T10:00", kept: false, label: "wave_hello", score: null }),
  take("three", { started: "2026-01-02T10:00", kept: null, score: 0.9, seconds: 5 }),
];
const ANN = { name: "Ann-20260101", operator: "Ann", day: "2026-01-01", takes: ["one", "three"] };
const names = (wanted, sessions = sessionsOf([ANN])) =>
  listed(TAKES, { words: "", verdict: "all", session: "", order: "newest", ...wanted }, sessions)
    .map(({ name }) => name)
    .join();

test("takes are found by words, verdict and session, in the order wanted", () => {
  assert.equal(names({}), "two,three,one");
  assert.equal(names({ order: "oldest" }), "one,three,two");
  assert.equal(names({ order: "best" }), "three,one,two");
  assert.equal(names({ order: "worst" }), "one,three,two"); // without a score last, both ways
  assert.equal(names({ order: "longest" }), "three,one,two"); // as they are trimmed
  assert.equal(names({ words: "hello wave" }), "two");
  assert.equal(names({ words: "ann" }), "three,one");
  assert.equal(names({ verdict: "kept" }), "one");
  assert.equal(names({ verdict: "new" }), "three");
  assert.equal(names({ verdict: "rejected" }), "two");
  assert.equal(names({ session: ANN.name, words: "o" }), "one");
});

test("a stretch goes from the row that was set last, either way", () => {
  const selection = new Selection();
  selection.stretch(ORDER, "b");
  assert.deepEqual(selection.of(ORDER), ["b"]);
  selection.stretch(ORDER, "d");
  assert.deepEqual(selection.of(ORDER), ["b", "c", "d"]);
  selection.set("c", false);
  selection.stretch(ORDER, "a");
  assert.deepEqual(selection.of(ORDER), ORDER);
  selection.retain(["a", "d"]);
  assert.deepEqual(selection.of(ORDER), ["a", "d"]);
  selection.clear();
  assert.equal(selection.size, 0);
  selection.all(["c", "d"]);
  assert.deepEqual(selection.of(ORDER), ["c", "d"]);
});

test("of many takes it is said how many were refused, and why", () => {
  assert.equal(became("kept", ["a"], {}), "1 take kept");
  const refused = Object.fromEntries([..."bcdef"].map((name) => [name, "no"]));
  const words = "1 of 6 takes kept · b: no · c: no · d: no · and 2 more";
  assert.equal(became("kept", ["a"], refused), words);
});

test("space is said as people say it", () => {
  assert.deepEqual([0, 1, 2500, 2.34e6, 45.6e6].map(space), [
    "0 kB",
    "1 kB",
    "3 kB",
    "2.3 MB",
    "46 MB",
  ]);
});
