import assert from "node:assert/strict";
import { test } from "node:test";

import { doing, stopped } from "../js/status.js";

/** What the line looks at. @type {any} */
const LIVE = { why: "", mode: "live", state: "stand", style: "march" };

test("the line says why nothing moves before anything else", () => {
  assert.equal(doing({ ...LIVE, why: "nobody is seen" }), "Nobody is seen");
  assert.equal(doing({ ...LIVE, mode: "collect", why: "stopped" }), "Stopped");
});

test("the line says what the studio does", () => {
  assert.equal(doing(LIVE), "Following: standing with you");
  const walking = { ...LIVE, state: "walk" };
  assert.equal(doing(walking), "Following: walking as you march");
  assert.equal(
    doing({ ...walking, style: "circles" }),
    "Following: walking as you circle your hands",
  );
  assert.equal(doing({ ...LIVE, state: "transition" }), "Following: changing its stance");
  assert.match(doing({ ...LIVE, mode: "collect" }), /shows what to act out/);
  assert.match(doing({ ...LIVE, mode: "replay" }), /as it was/);
});

test("a stop says what it was and what to press next", () => {
  const fell = stopped({ reason: "fallen", needs_reset: true });
  assert.equal(fell.title, "The robot fell");
  assert.match(fell.next, /Press Reset/);
  const up = stopped({ reason: "stopped", needs_reset: false });
  assert.equal(up.title, "Emergency stop");
  assert.match(up.next, /Press Arm/);
});
