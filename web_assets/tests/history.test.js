import assert from "node:assert/strict";
import { test } from "node:test";

import { HISTORY, TickHistory } from "../js/history.js";

test("a tick's work is the sum of its sections, without sums of others and waiting", () => {
  const history = new TickHistory(0);
  history.add({ timings_ms: { physics: 1, policy: 0.5, total: 9, wait: 20, inference: 3 } }, 10);
  assert.deepEqual(history.total, [1.5]);
  assert.deepEqual(
    [...history.sections],
    [
      ["physics", 1],
      ["policy", 0.5],
    ],
  );
  history.add({ timings_ms: { physics: 3, policy: 0.5 } }, 43);
  // 0.95 of what it was and 0.05 of what it is: 0.95 * 1 + 0.05 * 3 = 1.1.
  assert.ok(Math.abs(history.sections.get("physics") - 1.1) < 1e-12);
});

test("percentiles are of the last twenty seconds", () => {
  const history = new TickHistory(0);
  assert.equal(history.percentile(0.5), 0);
  for (let i = 0; i < HISTORY + 100; i += 1) history.add({ timings_ms: { all: i } }, 0);
  assert.equal(history.total.length, HISTORY);
  assert.equal(history.percentile(0), 100);
  assert.equal(history.percentile(0.5), 400);
  assert.equal(history.percentile(1), 699);
});

test("the rate is counted over whole seconds", () => {
  const history = new TickHistory(0);
  for (let i = 1; i <= 29; i += 1) history.add({ timings_ms: {} }, i * 30);
  assert.equal(history.rate, 0);
  history.add({ timings_ms: {} }, 1200);
  assert.equal(history.rate, 25); // 30 in 1.2 s
});
