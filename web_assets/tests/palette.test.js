import assert from "node:assert/strict";
import test from "node:test";

import { matching } from "../js/palette.js";

const entries = ["Mode: Live", "State: Walk", "Walking means: Marching", "Synthetic person: Walk"];
const found = (typed) =>
  matching(
    entries.map((words) => ({ words })),
    typed,
  ).map(({ words }) => words);

test("every typed word occurs, in any order and case", () => {
  assert.deepEqual(found(""), entries);
  assert.deepEqual(found("person WALK"), ["Synthetic person: Walk"]);
  assert.deepEqual(found("nothing"), []);
});

test("what begins with what was typed comes first", () => {
  assert.deepEqual(found("walk"), [
    "Walking means: Marching",
    "State: Walk",
    "Synthetic person: Walk",
  ]);
});
