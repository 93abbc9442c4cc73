import assert from "node:assert/strict";
import { test } from "node:test";

import { lateBy, standing } from "../js/findings.js";

test("a lag is worth an edit from half a frame on, unless somebody said to leave it", () => {
  const at = (lag) => ({ lag });
  assert.equal(lateBy({ lag: null }, at(0), at(0.3)), 0.3);
  assert.equal(lateBy({ lag: 0.3 }, at(0.3), at(0.3)), 0);
  assert.equal(lateBy({ lag: null }, at(0), at(0.016)), 0);
  assert.equal(lateBy({ lag: null }, at(0), at(0.017)), 0.017);
  assert.equal(lateBy({ lag: 0 }, at(0), at(0.3)), 0);
});

test("how a take stands with its lag is said in words", () => {
  assert.equal(standing({ lag: null, warped: false }, 0.7), "In time · agrees 0.70");
  assert.equal(standing({ lag: 0, warped: false }, 0.7), "Left as acted");
  assert.equal(standing({ lag: 0.3, warped: false }, 0.8), "Aligned by 0.30 s · agrees 0.80");
  const warped = "Aligned by 0.30 s and warped · agrees 0.80";
  assert.equal(standing({ lag: 0.3, warped: true }, 0.8), warped);
});
