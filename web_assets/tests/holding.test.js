import assert from "node:assert/strict";
import { test } from "node:test";

import { watching } from "../js/holding.js";

/** What a page that watches is told. */
const told = (/** @type {object} */ more) =>
  watching({ holder: "a", pages: ["a", "b"], free: false, away: false, ...more });

test("who watches is told who drives, and where nobody does, why", () => {
  assert.match(told({}), /Another page drives; this page can only stop/);
  assert.match(told({ away: true }), /Another page drives, out of sight;/);
  assert.match(told({ pages: ["b"], free: true }), /The page that drove is closed;/);
  assert.match(told({ free: true }), /The page that drives does not answer;/);
  assert.match(told({ holder: null, free: true }), /Nobody drives;/);
});
