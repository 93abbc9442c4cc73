import assert from "node:assert/strict";
import { test } from "node:test";

import { feetOf } from "../js/feet.js";
import { CORNERS, POINTS, Trail } from "../js/trails.js";

const DT = 1 / 30;
const feet = (x) => [0, 1, 2, 3].map((i) => [x, i, 0]);

/** A trail of feet that walk for so many ticks. */
function walked(ticks) {
  const trail = new Trail();
  for (let i = 0; i < ticks; i++) trail.add(10 + i * DT, feet(0.02 * i));
  return trail;
}

test("a trail keeps the last seconds and no more, however long the walk", () => {
  const trail = walked(3000);
  for (const foot of trail.points) {
    assert.equal(foot.length, POINTS);
    assert.ok(foot.at(-1)[0] > 0.02 * 2997);
    assert.ok(Math.abs(foot.at(-1)[0] - foot[0][0] - 0.02 * 2 * (POINTS - 1)) < 0.05);
  }
});

test("a robot that is set elsewhere, another clip and another time begin anew", () => {
  for (const [t, x] of [
    [10 + 100 * DT, 9],
    [200, 2],
    [3, 2],
  ]) {
    const trail = walked(100);
    trail.add(t, feet(x));
    assert.deepEqual(trail.points[0], [[x, 0, 0]]);
  }
});

test("a paused robot adds nothing", () => {
  const trail = walked(20);
  const before = trail.points[0].length;
  for (let i = 0; i < 50; i++) trail.add(10 + 19 * DT, feet(0.4));
  assert.equal(trail.points[0].length, before);
});

test("lines thin out to nothing and lie nowhere but between points", () => {
  const trail = walked(10);
  const corners = new Float32Array(CORNERS);
  trail.write(corners);
  assert.ok(corners.every(Number.isFinite));
  const [first, last] = [corners.slice(0, 18), corners.slice(18 * (POINTS - 1), 18 * POINTS)];
  assert.deepEqual([...first.filter((_, i) => i % 3 === 0)], Array(6).fill(first[0]));
  assert.ok(Math.max(...last.filter((_, i) => i % 3 === 2)) > 0.005);
  new Trail().write(corners);
  assert.ok(corners.every((c) => c === 0));
});

test("feet are where the legs' joints put them", () => {
  // Of studio/robot/legs.py.
  const robot = {
    base_pos: [1.0, -2.0, 0.3],
    base_quat: [0.8309424, 0.1618739, -0.0751675, 0.5269548],
    // prettier-ignore
    joint_pos: [-0.6, 0.409, -2.182, -0.273, 0.736, -1.855,
      0.055, 1.064, -1.527, 0.382, 1.391, -1.2],
  };
  const expected = [
    [1.302812, -1.799818, 0.283865],
    [1.028839, -1.695408, 0.14549],
    [0.975876, -2.174226, -0.062897],
    [0.621468, -2.206534, 0.044963],
  ];
  const found = feetOf(robot);
  found.forEach((foot, i) =>
    foot.forEach((c, k) => assert.ok(Math.abs(c - expected[i][k]) < 1e-5, `${i} ${c}`)),
  );
});
