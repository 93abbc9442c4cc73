import assert from "node:assert/strict";
import { mock, test } from "node:test";

import { Metronome } from "../js/metronome.js";

test("each step is told once, at its time, by its foot, however often we ask", (t) => {
  t.mock.timers.enable({ apis: ["setTimeout"] });
  const beats = [0.1, 0.6, 1.1];
  const onBeat = mock.fn();
  const metronome = new Metronome(onBeat);
  const told = () => onBeat.mock.calls.map(({ arguments: [foot] }) => foot);
  metronome.follow(beats, 0, false); // the first lies within what is scheduled ahead
  metronome.follow(beats, 0.05, false);
  t.mock.timers.tick(99);
  assert.deepEqual(told(), []);
  t.mock.timers.tick(1);
  assert.deepEqual(told(), [0]);
  metronome.follow(beats, 0.5, false);
  t.mock.timers.tick(100);
  assert.deepEqual(told(), [0, 1]);
  metronome.follow(beats, 2, false); // long past the third: it is not told late
  t.mock.timers.tick(5000);
  assert.deepEqual(told(), [0, 1]);
});

test("a motion that begins again is told again", (t) => {
  t.mock.timers.enable({ apis: ["setTimeout"] });
  const onBeat = mock.fn();
  const metronome = new Metronome(onBeat);
  metronome.follow([0.1, 9], 0, false);
  metronome.follow([0.1, 9], 3, false);
  metronome.follow([0.1, 9], 0, false);
  t.mock.timers.tick(1000);
  assert.equal(onBeat.mock.callCount(), 2);
});
