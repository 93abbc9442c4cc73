import assert from "node:assert/strict";
import { afterEach, beforeEach, mock, test } from "node:test";

import { Stops } from "../js/stops.js";

beforeEach(() => mock.timers.enable({ apis: ["setInterval"] }));
afterEach(() => mock.timers.reset());

/** Stops by a socket that is there or not, and by requests that are applied, refused or lost. */
const made = ({ there = true, post = async () => false } = {}) => {
  const sent = [];
  const confirmed = [];
  const ways = {
    there,
    send: (message) => ways.there && sent.push(message) > 0,
    post: mock.fn(post),
    confirmed: (ms) => confirmed.push(ms),
  };
  return { ways, sent, confirmed, stops: new Stops(ways) };
};
const settled = () => new Promise((done) => setImmediate(done));

test("a stop that is confirmed was sent once, by the socket alone", async () => {
  const { ways, sent, confirmed, stops } = made();
  stops.press();
  assert.deepEqual(sent, [{ type: "stop", number: 1 }]);
  stops.confirm(1);
  mock.timers.tick(5000);
  assert.equal(sent.length, 1);
  assert.equal(ways.post.mock.callCount(), 0);
  assert.equal(confirmed.length, 1);
  assert.ok(!stops.waiting);
});

test("a stop that is not confirmed is sent both ways until it is", async () => {
  const { ways, sent, confirmed, stops } = made();
  stops.press();
  mock.timers.tick(1500);
  await settled();
  assert.equal(sent.length, 6);
  assert.equal(ways.post.mock.callCount(), 5);
  assert.ok(stops.waiting);
  ways.post.mock.mockImplementation(async () => true);
  mock.timers.tick(300);
  await settled();
  assert.equal(confirmed.length, 1);
  mock.timers.tick(3000);
  assert.equal(sent.length, 7);
});

test("without a socket a stop goes by HTTP at once, and by the socket when it is back", () => {
  const { ways, sent, stops } = made({ there: false, post: () => Promise.reject(new Error()) });
  stops.press();
  assert.equal(ways.post.mock.callCount(), 1);
  assert.deepEqual(sent, []);
  ways.there = true;
  stops.reconnected();
  assert.deepEqual(sent, [{ type: "stop", number: 1 }]);
});

test("of two presses the second has to be confirmed", () => {
  const { sent, confirmed, stops } = made();
  stops.press();
  stops.press();
  stops.confirm(1);
  assert.ok(stops.waiting);
  stops.confirm(2);
  assert.ok(!stops.waiting);
  stops.confirm(2);
  assert.equal(confirmed.length, 1);
  assert.deepEqual(
    sent.map((message) => message.number),
    [1, 2],
  );
});

test("nothing is sent where nothing was pressed", () => {
  const { ways, sent, stops } = made();
  stops.reconnected();
  stops.confirm(1);
  mock.timers.tick(1000);
  assert.deepEqual([sent.length, ways.post.mock.callCount()], [0, 0]);
});
