import assert from "node:assert/strict";
import { test } from "node:test";

import { Painter } from "../js/painter.js";
import { halves } from "../js/panes.js";

test("halves lie side by side, or one over the other, and leave nothing out", () => {
  for (const [width, height] of [
    [901, 480],
    [390, 401],
  ]) {
    const [person, robots] = halves(width, height);
    const area = (rect) => rect.width * rect.height;
    assert.equal(area(person) + area(robots), width * height);
    assert.deepEqual([robots.x + robots.width, robots.y + robots.height], [width, height]);
    assert.equal(person.x + person.y, 0);
    assert.equal(robots.y === 0, width > height);
  }
});

test("what covers the left is the person's, and both have as much of the rest", () => {
  const [person, robots] = halves(900, 400, 300);
  assert.deepEqual([person.width, robots.x, robots.width], [600, 600, 300]);
});

/** A view of 900 by 400 px, and all that was done with it. @returns {any} */
function view() {
  const done = [];
  const vector = () => ({ clone: vector, copy: vector, add: vector, sub: vector });
  const camera = (name) => ({
    name,
    aspect: 1,
    position: vector(),
    quaternion: { copy() {} },
    updateProjectionMatrix() {},
    setViewOffset() {},
    clone: () => camera("beside"),
  });
  const names = ["human", "reference", "robot"];
  const viser = /** @type {any} */ ({
    camera: camera("main"),
    canvas: { clientWidth: 900, clientHeight: 400 },
    scene: { onBeforeRender: undefined, onAfterRender: undefined },
    nodeRefFromName: Object.fromEntries(names.map((name) => [`/${name}`, { visible: true }])),
  });
  const seen = () => names.filter((name) => viser.nodeRefFromName[`/${name}`].visible);
  const renderer = {
    setViewport: (...at) => (viser.at = at),
    setScissor() {},
    setScissorTest: (on) => (viser.cut = on),
    render(scene, by) {
      scene.onBeforeRender(renderer, scene, by);
      done.push([by.name, viser.at, seen().join()]);
      scene.onAfterRender(renderer, scene, by);
    },
  };
  return { viser, renderer, done, seen };
}

test("a split view is two pictures, of robots and person, and leaves all as it was", () => {
  const { viser, renderer, done, seen } = view();
  const panes = {
    split: true,
    covered: 0,
    more: new Set(),
    of: (_, figure) => ({ at: halves(900, 400)[figure === "human" ? 0 : 1] }),
  };
  new Painter(/** @type {any} */ (panes)).attach(viser);
  renderer.render(viser.scene, viser.camera);
  assert.deepEqual(done, [
    ["main", [450, 0, 450, 400], "reference,robot"],
    ["beside", [0, 0, 450, 400], "human"],
  ]);
  assert.deepEqual([viser.at, viser.cut, seen().length], [[0, 0, 900, 400], false, 3]);
  assert.equal(viser.camera.aspect, 450 / 400);
});

test("one more picture is drawn over the whole, by its own camera", () => {
  const { viser, renderer, done } = view();
  const whole = { x: 0, y: 0, width: 900, height: 400 };
  const panes = {
    split: false,
    covered: 0,
    more: new Set([
      (draw) => draw({ ...viser.camera, name: "eye" }, { x: 14, y: 200, width: 264, height: 176 }),
    ]),
    of: () => ({ camera: viser.camera, at: whole }),
  };
  const painter = new Painter(/** @type {any} */ (panes));
  for (let i = 0; i < 2; i++) painter.attach(viser);
  viser.at = "untouched";
  renderer.render(viser.scene, viser.camera);
  assert.deepEqual(
    done.map(([by, at]) => [by, at]),
    [
      ["main", "untouched"],
      ["eye", [14, 24, 264, 176]],
    ],
  );
  assert.equal(viser.cut, false);
});
