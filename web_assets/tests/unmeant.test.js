import assert from "node:assert/strict";
import { test } from "node:test";

import { Unmeant } from "../js/unmeant.js";

test("buttons are not meant while others stood there a moment ago", () => {
  const unmeant = new Unmeant();
  unmeant.draw("skip abort", 0);
  assert.ok(unmeant.is(100));
  assert.ok(!unmeant.draw("skip abort", 1000), "those that stay can be pressed");
  assert.ok(unmeant.draw("keep redo next", 2000));
  assert.ok(unmeant.is(2400));
  assert.ok(!unmeant.draw("keep redo next", 2700));
  assert.ok(!unmeant.is(2700));
});
