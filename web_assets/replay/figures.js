// The figures of a take at an instant: person, what was shown, what physics made of it.

import { bone, links, placed } from "./space.js";
import { ball, disc, limb, solid, unpacked } from "./solids.js";

/** @import { Mesh, Painter, Thing } from "./painter.js" */
/** @import { Vec } from "./space.js" */

/**
 * A robot's motion, N frames. data: per frame x y z of the trunk in mm from where its column has
 * followed it, its quaternion (wxyz) in 1/32767, 12 angles in 1/7,000 rad, the feet that stand as
 * bits.
 *
 * @typedef {{ title: string, data: string, color: number[] | null }} Robot
 */
/**
 * The person's, 19 joints in mm in the same way. bones: of each the joints that it joins, and its
 * radii in m.
 *
 * @typedef {{ title: string, data: string, bones: number[][], joints: number[],
 *   left: number[], colors: number[][] }} Person
 */
/**
 * What the file holds.
 *
 * @typedef {object} Take
 * @property {string} name
 * @property {string} label
 * @property {number} fps
 * @property {string[]} states
 * @property {Person | null} person
 * @property {Robot[]} robots the last is the one that physics moved
 * @property {string} passed N times (x, y) m that its column has followed it
 * @property {{ vertices: string, faces: string, unit: number }[]} shapes
 * @property {{ shape: number, color: number[] }[]} links
 * @property {{ hip: Vec[], thigh: Vec[], calf: Vec }} offsets
 * @property {number} foot m from the calf's frame to the foot
 */

const ROW = 20; // numbers a frame of a robot
const JOINTS = 19;
const SCALE = 0.56; // of the person: at full size they would dwarf a robot 0.3 m high
const STANDS = [0.18, 0.8, 0.51, 1];
const LIFTED = [0.47, 0.5, 0.57, 1];
const GAP = 0.86; // m between two figures
const GAP_ABOVE = 0.1; // m between a figure and its caption
const REACH = 0.2; // m that a trunk reaches ahead of its middle

/** Each stays in its column: where the robot walks, the floor passes under them. */
export class Figures {
  /** @param {Take} take @param {Painter} painter */
  constructor(take, painter) {
    this.take = take;
    this.frames = take.states.length;
    this.shapes = take.shapes.map(({ vertices, faces, unit }) => {
      const places = Float32Array.from(unpacked(vertices, Int16Array), (v) => v * unit);
      return painter.mesh(solid(places, unpacked(faces, Uint16Array)));
    });
    this.ball = painter.mesh(ball());
    this.limb = painter.mesh(limb());
    this.disc = painter.mesh(disc());
    this.robots = take.robots.map(({ data }) => unpacked(data, Int16Array));
    this.person = take.person && unpacked(take.person.data, Int16Array);
    this.floor = unpacked(take.passed, Float32Array);
    const count = this.robots.length + (this.person ? 1 : 0);
    this.columns = Array.from({ length: count }, (_, i) => GAP * (i - (count - 1) / 2));
  }

  /** What they are called, from left to right. */
  get titles() {
    const { person, robots } = this.take;
    return [...(person ? [person.title] : []), ...robots.map(({ title }) => title)];
  }

  /** Points over each that its caption hangs at, m. @param {Thing[][]} shown what `at` gave */
  tops(shown) {
    return shown.map((things, i) => {
      const low = this.person && i === 0 ? 0.98 : 0.5;
      const top = Math.max(low, ...things.map(({ model }) => model[14] + REACH * model[2]));
      return /** @type {Vec} */ ([0, this.columns[i], top + GAP_ABOVE]);
    });
  }

  /** How far the floor has passed, m. @param {number} frame */
  passed(frame) {
    const under = this.columns.at(-1) ?? 0;
    return [this.floor[2 * frame], this.floor[2 * frame + 1] - under];
  }

  /** What each figure consists of. @param {number} frame @returns {Thing[][]} */
  at(frame) {
    const first = this.columns.length - this.robots.length;
    const robots = this.robots.map((_, i) => this.#robot(i, frame, first + i));
    return this.person ? [this.#person(frame), ...robots] : robots;
  }

  /** @param {number} i @param {number} frame @param {number} column */
  #robot(i, frame, column) {
    const row = this.robots[i].subarray(ROW * frame, ROW * (frame + 1));
    const pos = [row[0] / 1000, row[1] / 1000 + this.columns[column], row[2] / 1000];
    const quat = Array.from(row.subarray(3, 7), (v) => v / 32767);
    const joints = Array.from(row.subarray(7, 19), (v) => v / 7000);
    const tint = this.take.robots[i].color;
    const models = links(pos, quat, joints, this.take.offsets);
    /** @type {Thing[]} */
    const things = models.map((model, k) => {
      const { shape, color } = this.take.links[k];
      return { mesh: this.shapes[shape], model, color: [...(tint ?? color), 1], casts: true };
    });
    for (let leg = 0; leg < 4; leg++) {
      const calf = models[3 * leg + 3];
      const foot = [0, 1].map((k) => calf[12 + k] - calf[8 + k] * this.take.foot);
      const stands = (row[19] >> leg) & 1;
      const size = stands ? 0.036 : 0.022;
      const model = placed([...foot, 0.002], [1, 0, 0, 0], [size, size, 1]);
      things.push({ mesh: this.disc, model, color: stands ? STANDS : LIFTED });
    }
    return things;
  }

  /** @param {number} frame */
  #person(frame) {
    const { bones, joints, left, colors } = /** @type {Person} */ (this.take.person);
    const row = /** @type {Int16Array} */ (this.person).subarray(3 * JOINTS * frame);
    /** @type {Vec[]} */
    const points = joints.map((_, i) => [
      (SCALE * row[3 * i]) / 1000,
      (SCALE * row[3 * i + 1]) / 1000 + this.columns[0],
      (SCALE * row[3 * i + 2]) / 1000,
    ]);
    const side = [0, 1, 2].map((k) => points[left[0]][k] - points[left[1]][k]);
    /** @type {Thing[]} */
    const limbs = bones.map(([from, to, across, deep]) => ({
      mesh: this.limb,
      model: bone(points[from], points[to], SCALE * across, SCALE * deep, side),
      color: [...colors[to], 1],
      casts: true,
    }));
    const balls = points.map((point, i) => ({
      mesh: this.ball,
      model: placed(point, [1, 0, 0, 0], Array(3).fill(SCALE * joints[i])),
      color: [...colors[i], 1],
      casts: true,
    }));
    return [...limbs, ...balls];
  }
}
