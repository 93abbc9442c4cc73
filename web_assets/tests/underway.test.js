import assert from "node:assert/strict";
import { test } from "node:test";

import { underWay } from "../js/underway.js";

/** What it looks at of a tick. @type {any} */
const STANDS = { mode: "live", state: "stand", transition_to: null, votes: { walk: 0 } };

test("walking is under way from the key until the robot walks", () => {
  assert.equal(underWay(STANDS, false), null);
  const shares = [
    STANDS,
    { ...STANDS, votes: { walk: 0.5 } },
    { ...STANDS, state: "transition", transition_to: "walk", votes: { walk: 1 } },
  ].map((tick) => underWay(tick, true).share);
  assert.deepEqual(shares, [0, 0.3, 0.6]);
  assert.equal(underWay({ ...STANDS, state: "walk" }, true), null);
});
