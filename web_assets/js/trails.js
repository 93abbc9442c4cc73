// Where the robots' feet have been in the last seconds: thin lines in the 3-D view.

import { feetOf } from "./feet.js";

/** @import { Mesh3D, State, Tick, Viser } from "../types/page.js" */

/** s that a trail is kept; s between two of its points. */
const LASTS = 4;
const EVERY = 1 / 15;
export const POINTS = LASTS / EVERY;
/** m: a foot that went further between two ticks was set there. s: what a clip may leave out. */
const JUMP = 0.5;
const GAP = 1;
/** m: half of a line's width where the foot is; it thins to nothing. */
const WIDTH = 0.007;
const ROBOTS = /** @type {const} */ (["reference", "robot"]);
const FEET = 4;
/** Ways in which each point is drawn wide: three ribbons that cross are a line from anywhere. */
const SPREAD = [0, 1, 2].flatMap((axis) =>
  [-1, 1].map((side) => [0, 1, 2].map((k) => (k === axis ? side : 0))),
);

/** Numbers of the corners of a robot's trails. */
export const CORNERS = 3 * FEET * POINTS * SPREAD.length;

/** What one robot's feet have passed: of each, its newest `POINTS` points at most. */
export class Trail {
  /** @type {number[][][]} */
  points = Array.from({ length: FEET }, () => []);
  #t = NaN;
  /** @type {number[][]} */
  #last = [];

  clear() {
    for (const foot of this.points) foot.length = 0;
  }

  /** @param {number} t s @param {number[][]} feet (4, 3) m @returns {boolean} whether it grew */
  add(t, feet) {
    const far = (/** @type {number[]} */ foot, /** @type {number} */ i) =>
      Math.hypot(...foot.map((c, k) => c - this.#last[i][k])) > JUMP;
    if (this.#last.length && feet.some(far)) this.clear();
    this.#last = feet;
    if (!(Math.abs(t - this.#t) < GAP && t >= this.#t)) {
      this.clear();
      this.#t = -Infinity;
    }
    if (t - this.#t < EVERY - 1e-3) return false;
    this.#t = t;
    this.points.forEach((foot, i) => {
      foot.push(feet[i]);
      if (foot.length > POINTS) foot.shift();
    });
    return true;
  }

  /** Write its lines' corners. @param {Float32Array} corners */
  write(corners) {
    let at = 0;
    for (const foot of this.points) {
      // What a young trail lacks lies in its first point, and is nothing.
      const lacks = POINTS - foot.length;
      for (let i = 0; i < POINTS; i++) {
        const point = foot[Math.max(0, i - lacks)] ?? [0, 0, 0];
        const wide = foot.length ? (WIDTH * i) / POINTS : 0;
        for (const way of SPREAD)
          for (let k = 0; k < 3; k++) corners[at++] = point[k] + wide * way[k];
      }
    }
  }
}

/** Triangles between each two points of the same foot: indices of corners. */
function triangles() {
  const out = [];
  for (let foot = 0; foot < FEET; foot++)
    for (let i = 0; i < POINTS - 1; i++)
      for (let ribbon = 0; ribbon < 3; ribbon++) {
        const a = SPREAD.length * (foot * POINTS + i) + 2 * ribbon;
        const b = a + SPREAD.length;
        out.push(a, a + 1, b, a + 1, b + 1, b);
      }
  return out;
}

/**
 * A mesh of a trail's corners, made of what viser draws its own axes with: three.js itself is
 * hidden in its bundle.
 *
 * @param {Viser["scene"]} scene
 */
function meshFrom(scene) {
  /** @type {Mesh3D[]} */
  const like = [];
  scene.traverse((thing) => {
    const { isMesh, material, geometry } = thing;
    if (isMesh && material.type === "MeshBasicMaterial" && geometry.type === "BufferGeometry")
      like.push(/** @type {Mesh3D} */ (thing));
  });
  if (!like.length) throw new Error("this 3-D view draws no trails");
  const [{ constructor: Mesh, geometry, material }] = like;
  const made = new geometry.constructor();
  const { array, constructor: Attribute } = geometry.attributes.position;
  // Of the view's own window: WebGL there knows no arrays of another.
  const Floats = /** @type {Float32ArrayConstructor} */ (array.constructor);
  made.setAttribute("position", new Attribute(new Floats(CORNERS), 3));
  made.setIndex(triangles());
  const paint = new material.constructor({ transparent: true, opacity: 0.75, side: 2 });
  paint.toneMapped = false;
  paint.depthWrite = false;
  const mesh = new Mesh(made, paint);
  mesh.frustumCulled = false;
  return mesh;
}

export class Trails {
  #trails = { reference: new Trail(), robot: new Trail() };
  /** @type {Partial<Record<(typeof ROBOTS)[number], Mesh3D>>} */
  #meshes = {};
  #scene = /** @type {Viser["scene"] | null} */ (null);
  #key = "";
  #down = false;
  #theme = "";

  /** A tick, and the newest state. @param {Tick} tick @param {State | null} state */
  add(tick, state) {
    const { mode, scene, source, needs_reset = false, replay } = state ?? {};
    const key = [tick.mode, mode, scene, source, replay?.name].join();
    const rose = this.#down && !needs_reset;
    this.#down = needs_reset;
    if (key !== this.#key || rose) for (const name of ROBOTS) this.#trails[name].clear();
    this.#key = key;
    const feet = { reference: feetOf(tick.reference), robot: tick.robot.foot_pos_w };
    for (const name of ROBOTS) if (this.#trails[name].add(tick.t, feet[name])) this.#write(name);
  }

  /** @param {(typeof ROBOTS)[number]} name */
  #write(name) {
    const position = this.#meshes[name]?.geometry.attributes.position;
    if (!position) return;
    this.#trails[name].write(position.array);
    position.needsUpdate = true;
  }

  /** Every frame: there where the robots' worlds are. @param {Viser} viser */
  draw(viser) {
    const { scene, nodeRefFromName, requestRender } = viser;
    if (scene !== this.#scene) this.#meshes = {}; // the view was loaded anew
    this.#scene = scene;
    const { theme = "" } = document.documentElement.dataset;
    for (const name of ROBOTS) {
      const world = nodeRefFromName[`/${name}/world`];
      const mesh = world && (this.#meshes[name] ??= meshFrom(scene));
      if (!mesh || (mesh.parent === world && theme === this.#theme)) continue;
      world.add(mesh);
      mesh.material.color.set(
        getComputedStyle(document.body).getPropertyValue(`--${name}`).trim(),
      );
      this.#write(name);
      requestRender();
    }
    this.#theme = theme;
  }

  /** Gone, if it was there. @param {Viser} viser */
  remove({ requestRender }) {
    for (const name of ROBOTS) {
      if (!this.#meshes[name]?.parent) continue;
      this.#meshes[name]?.removeFromParent();
      this.#trails[name].clear();
      requestRender();
    }
  }
}
