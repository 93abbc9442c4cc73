import assert from "node:assert/strict";
import { test } from "node:test";

import { laid } from "../js/cameras.js";
import { haunt } from "../js/ghosts.js";

/** Meshes of a robot, and one of its world. @returns {any} */
function figure() {
  const mesh = (opacity) => ({
    isMesh: true,
    children: [],
    material: { opacity, transparent: opacity < 1, depthWrite: true, userData: {} },
  });
  const world = { children: [mesh(1)] };
  const robot = { children: [{ children: [mesh(1), mesh(0.5)] }, world] };
  let asked = 0;
  const viser = {
    nodeRefFromName: { "/robot": robot, "/robot/world": world },
    requestRender: () => (asked += 1),
  };
  const seen = () =>
    [...robot.children[0].children, world.children[0]].map(({ material }) => material.opacity);
  return { viser, seen, asked: () => asked };
}

test("a ghost is seen through, what is in its world is not, and it comes back as it was", () => {
  const shown = figure();
  haunt(shown.viser, "robot", true);
  const [one, other, prop] = shown.seen();
  assert.ok(one < 0.5 && other < one && prop === 1);
  haunt(shown.viser, "robot", false);
  assert.deepEqual(shown.seen(), [1, 0.5, 1]);
});

test("who is a ghost already asks for no further picture", () => {
  const shown = figure();
  haunt(shown.viser, "robot", true);
  const [before, seen] = [shown.asked(), shown.seen()];
  for (let i = 0; i < 10; i++) haunt(shown.viser, "robot", true);
  assert.equal(shown.asked(), before);
  assert.deepEqual(shown.seen(), seen);
  haunt(shown.viser, "nobody", true);
});

test("what is laid over another comes to its place however it is turned", () => {
  const column = /** @type {[number, number]} */ ([0.3, -0.6]);
  const place = /** @type {[number, number]} */ ([0.1, 0.9]);
  for (const turn of [0, 1, -3]) {
    const by = laid(column, place, turn);
    const [c, s] = [Math.cos(turn), Math.sin(turn)];
    assert.ok(Math.abs(by[0] + c * column[0] - s * column[1] - place[0]) < 1e-12);
    assert.ok(Math.abs(by[1] + s * column[0] + c * column[1] - place[1]) < 1e-12);
  }
});
