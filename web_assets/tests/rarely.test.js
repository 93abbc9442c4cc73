import assert from "node:assert/strict";
import test from "node:test";

import { rarely } from "../js/rarely.js";

test("the first goes at once, those too soon after it are left out, never the last", (t) => {
  t.mock.timers.enable({ apis: ["setTimeout"] });
  t.mock.method(performance, "now", () => now);
  let now = 1000;
  const sent = [];
  const send = rarely(60, (value) => sent.push(value));
  for (const value of [1, 2, 3]) send(value);
  assert.deepEqual(sent, [1]);
  t.mock.timers.tick(60);
  assert.deepEqual(sent, [1, 3]);
  now += 100;
  send(4);
  assert.deepEqual(sent, [1, 3, 4]);
});
