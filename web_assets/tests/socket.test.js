import assert from "node:assert/strict";
import { afterEach, beforeEach, mock, test } from "node:test";

import { LastingSocket, socketUrl } from "../js/socket.js";

/** A socket of no network: it does what a test says. */
class FakeSocket {
  static OPEN = 1;
  /** @type {FakeSocket[]} */
  static all = [];
  readyState = 0;
  /** @type {string[]} */
  sent = [];
  onopen = () => {};
  onclose = () => {};
  /** @type {(event: { data: string }) => void} */
  onmessage = () => {};

  /** @param {string} url */
  constructor(url) {
    this.url = url;
    FakeSocket.all.push(this);
  }

  open() {
    this.readyState = FakeSocket.OPEN;
    this.onopen();
  }

  close() {
    this.readyState = 3;
    this.onclose();
  }

  /** @param {string} text */
  send(text) {
    this.sent.push(text);
  }
}

const given = /** @type {any} */ (globalThis);
const newest = () => /** @type {FakeSocket} */ (FakeSocket.all.at(-1));

beforeEach(() => {
  mock.timers.enable({ apis: ["setTimeout"] });
  FakeSocket.all = [];
  given.WebSocket = FakeSocket;
  given.location = { protocol: "https:", host: "studio:8001" };
});
afterEach(() => {
  mock.timers.reset();
  delete given.location;
});

test("a socket is where the page is, and as safe", () => {
  assert.equal(socketUrl("/api/ticks"), "wss://studio:8001/api/ticks");
  given.location.protocol = "http:";
  assert.equal(socketUrl("/api/ticks"), "ws://studio:8001/api/ticks");
});

test("what comes is read; what cannot be sent is said to be lost", () => {
  /** @type {unknown[]} */
  const heard = [];
  const socket = new LastingSocket("/api/ticks", { heard: (message) => heard.push(message) });
  assert.equal(socket.send({ a: 1 }), false);
  newest().open();
  assert.equal(socket.send({ a: 2 }), true);
  newest().onmessage({ data: '{"index":3}' });
  assert.deepEqual(heard, [{ index: 3 }]);
  newest().close();
  assert.equal(socket.send({ a: 4 }), false);
  assert.deepEqual(newest().sent, ['{"a":2}']);
});

test("a lost connection is made again, ever less often, and soon after one that held", () => {
  const [up, down] = [mock.fn(), mock.fn()];
  const socket = new LastingSocket("/api/control", { heard: () => {}, up, down });
  newest().open();
  for (const wait of [250, 500, 1000, 2000, 2000]) {
    const before = FakeSocket.all.length;
    newest().close();
    mock.timers.tick(wait - 1);
    assert.equal(FakeSocket.all.length, before, `${wait} ms`);
    mock.timers.tick(1);
    assert.equal(FakeSocket.all.length, before + 1, `${wait} ms`);
  }
  newest().open();
  assert.ok(socket.send({}));
  newest().close();
  mock.timers.tick(250);
  assert.equal(FakeSocket.all.length, 7);
  assert.equal(up.mock.callCount(), 2);
  assert.equal(down.mock.callCount(), 6);
});
