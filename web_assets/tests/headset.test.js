import assert from "node:assert/strict";
import test from "node:test";

import { BODY, Still, pressed, worn } from "../js/headset-frame.js";

/** @type {any} */
const FLOOR = "the floor";
const HEAD = { x: 0.1, y: 1.65, z: -0.2, emulatedPosition: false };

/** A frame in which each space is where it says. @returns {any} */
function frameOf({ head = HEAD, inputs = [], body = undefined } = {}) {
  const posed = ({ x, y, z, emulatedPosition = false }) => ({
    transform: { position: { x, y, z }, orientation: { x: 0, y: 0, z: 0, w: 1 } },
    emulatedPosition,
  });
  return {
    session: { inputSources: inputs },
    body,
    getViewerPose: (floor) => (head && floor === FLOOR ? posed(head) : null),
    getPose: (space, floor) => (space && floor === FLOOR ? posed(space) : null),
  };
}
const controller = (handedness, gripSpace, axes = [0, 0, 0, 0], down = []) => ({
  handedness,
  gripSpace,
  gamepad: { axes, buttons: Array.from({ length: 6 }, (_, k) => ({ pressed: down.includes(k) })) },
});

test("head, hands and the stick that is pushed further are told, by side", () => {
  const inputs = [
    controller("right", { x: 0.3, y: 1, z: -0.1 }, [0, 0, 0.2, -0.9]),
    controller("left", { x: -0.3, y: 1, z: -0.1 }, [0, 0, 0.1, 0]),
  ];
  assert.deepEqual(worn(frameOf({ inputs }), FLOOR, 2), {
    t: 2,
    head: [0.1, 1.65, -0.2, 0, 0, 0, 1],
    left: [-0.3, 1, -0.1],
    right: [0.3, 1, -0.1],
    stick: [0.2, -0.9],
    body: null,
  });
});

test("a hand that is tracked as one is where its wrist is", () => {
  const hand = new Map([["wrist", { x: -0.2, y: 1.2, z: 0 }]]);
  const inputs = [{ handedness: "left", gripSpace: { x: 9, y: 9, z: 9 }, hand }];
  assert.deepEqual(worn(frameOf({ inputs }), FLOOR, 0)?.left, [-0.2, 1.2, 0]);
});

test("what the headset only guesses is not told, and without a head nothing is", () => {
  const lost = controller("left", { x: 0, y: 1, z: 0, emulatedPosition: true });
  assert.equal(worn(frameOf({ inputs: [lost] }), FLOOR, 0)?.left, null);
  assert.equal(worn(frameOf({ head: null }), FLOOR, 0), null);
  assert.equal(worn(frameOf({ head: { ...HEAD, emulatedPosition: true } }), FLOOR, 0), null);
});

test("a body that the browser tracks is told joint by joint, in the studio's order", () => {
  const body = new Map([["left-arm-lower", { x: 1, y: 2, z: 3 }]]);
  const told = worn(frameOf({ body }), FLOOR, 0)?.body;
  assert.equal(told?.length, 15);
  assert.deepEqual(told?.[BODY.indexOf("left-arm-lower")], [1, 2, 3]);
  assert.equal(told?.filter(Boolean).length, 1);
});

test("B and Y stop, A and X go on", () => {
  const at = (...down) => pressed(frameOf({ inputs: [controller("left", HEAD, [], down)] }));
  assert.deepEqual(at(), { stop: false, again: false });
  assert.deepEqual(at(5), { stop: true, again: false });
  assert.deepEqual(at(4, 0), { stop: false, again: true });
});

test("the ring is full after a second and a half of keeping still, the stick at rest", () => {
  const still = new Still();
  /** @returns {any} */
  const seen = (t, x = 0, stick = [0, 0]) => ({
    t,
    head: [x, 1.6, 0],
    left: null,
    right: [0, 1, 0],
    stick,
  });
  assert.equal(still.push(seen(10)), 0);
  for (let t = 10.1; t < 11; t += 0.1) assert.ok(still.push(seen(t)) < 1);
  assert.equal(still.push(seen(11.05, 0.3)), 0);
  assert.equal(still.push(seen(11.1, 0.3, [0, -1])), 0);
  for (let t = 11.2; t < 14; t += 0.1) still.push(seen(t, 0.3));
  assert.equal(still.push(seen(14, 0.3)), 1);
  assert.equal(still.push(seen(16, 0.3)), 0, "nobody was seen meanwhile");
});
