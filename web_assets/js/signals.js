// What is asked of the robot beside what it does, as numbers over time: without a page.

import { HISTORY } from "./history.js";
import { FRAME, angles } from "./motion.js";

/** @import { Tick } from "../types/page.js" */

/** Ticks over which a turn is measured. */
const TURN_OVER = 6;
/** Ticks that a lag is looked for over, and the most that it can be. */
const LAG_OVER = 90;
const LAG_MOST = 12;
/** rad: where the joints asked for move less there is no lag to see. */
const MOVES = 0.02;
const DEG = 180 / Math.PI;
/** Of a sample's numbers, by the first word of their names. @type {Record<string, string>} */
const UNITS = {
  t: "s",
  speed: "m_s",
  turn: "deg_s",
  roll: "deg",
  pitch: "deg",
  height: "cm",
  paw: "cm",
  joint: "deg",
};

/**
 * Plots by name: a title, a unit, decimals, and the curves' names in `Sample`.
 *
 * @type {Record<string, { title: string, unit: string, digits: number,
 *   curves: [keyof Sample, string][] }>}
 */
export const PLOTS = {
  speed: { title: "Speed", unit: "m/s", digits: 2, curves: pair("speed") },
  turn: { title: "Turn", unit: "°/s", digits: 0, curves: pair("turn") },
  roll: { title: "Tilt sideways", unit: "°", digits: 1, curves: pair("roll") },
  pitch: { title: "Tilt forward", unit: "°", digits: 1, curves: pair("pitch") },
  height: { title: "Trunk height", unit: "cm", digits: 1, curves: pair("height") },
  paws: {
    title: "Front paws' height",
    unit: "cm",
    digits: 1,
    curves: [
      ["pawRight", "right"],
      ["pawLeft", "left"],
    ],
  },
  error: {
    title: "Joint error, RMS",
    unit: "°",
    digits: 1,
    curves: [["jointError", "between asked and done"]],
  },
};

/**
 * One tick: s, m/s, °/s, °, cm.
 *
 * @typedef {Record<"t" | "speedAsked" | "speedDone" | "turnAsked" | "turnDone" | "rollAsked" |
 *   "rollDone" | "pitchAsked" | "pitchDone" | "heightAsked" | "heightDone" | "pawRight" |
 *   "pawLeft" | "jointError", number>} Sample
 */

/**
 * @param {"speed" | "turn" | "roll" | "pitch" | "height"} name
 * @returns {[keyof Sample, string][]}
 */
function pair(name) {
  return [
    [`${name}Asked`, "asked"],
    [`${name}Done`, "done"],
  ];
}

/** An angle (rad) as the shortest way to it. @param {number} a */
const shortest = (a) => Math.atan2(Math.sin(a), Math.cos(a));

/** The last 20 s of ticks. */
export class Signals {
  /** @type {Sample[]} */
  samples = [];
  /** Yaws (rad) and joints (rad) of the last ticks, asked and done. */
  #yaws = /** @type {[number, number][]} */ ([]);
  #joints = /** @type {[number[], number[]][]} */ ([]);
  #index = 0;

  /** @param {Pick<Tick, "index" | "t" | "reference" | "robot">} tick */
  add({ index, t, reference, robot }) {
    if (index <= this.#index) this.clear(); // another run: a loop that catches up repeats times
    this.#index = index;
    const [asked, done] = [reference.base_quat, robot.base_quat].map(angles);
    const forward = (/** @type {number[]} */ v, /** @type {number} */ yaw) =>
      v[0] * Math.cos(yaw) + v[1] * Math.sin(yaw);
    const before = this.#yaws.at(-TURN_OVER);
    const since = this.samples.at(-TURN_OVER)?.t ?? t;
    const turn = (/** @type {number} */ now, /** @type {number | undefined} */ then) =>
      then === undefined || t <= since ? 0 : (DEG * shortest(now - then)) / (t - since);
    const misses = reference.joint_pos.map((q, i) => (q - robot.joint_pos[i]) ** 2);
    keep(this.samples, HISTORY, {
      t,
      speedAsked: forward(reference.base_lin_vel_w, asked.yaw),
      speedDone: forward(robot.base_lin_vel_w, done.yaw),
      turnAsked: turn(asked.yaw, before?.[0]),
      turnDone: turn(done.yaw, before?.[1]),
      rollAsked: DEG * asked.roll,
      rollDone: DEG * done.roll,
      pitchAsked: DEG * asked.pitch,
      pitchDone: DEG * done.pitch,
      heightAsked: 100 * reference.base_pos[2],
      heightDone: 100 * robot.base_pos[2],
      pawRight: 100 * robot.foot_pos_w[0][2],
      pawLeft: 100 * robot.foot_pos_w[1][2],
      jointError: DEG * Math.sqrt(misses.reduce((sum, e) => sum + e, 0) / misses.length),
    });
    keep(this.#yaws, TURN_OVER, [asked.yaw, done.yaw]);
    keep(this.#joints, LAG_OVER + LAG_MOST, [reference.joint_pos, robot.joint_pos]);
  }

  clear() {
    for (const list of [this.samples, this.#yaws, this.#joints]) list.length = 0;
  }

  /** ms by which the robot's joints follow those asked for; null where these do not move. */
  get lag() {
    const rows = this.#joints;
    if (rows.length < LAG_OVER + LAG_MOST) return null;
    const recent = rows.slice(LAG_MOST);
    const off = (/** @type {number} */ shift) =>
      recent.reduce((sum, [, done], i) => sum + apart(rows[LAG_MOST + i - shift][0], done), 0);
    const first = recent[0][0];
    const moved = recent.reduce((most, [asked]) => Math.max(most, apart(asked, first)), 0);
    if (Math.sqrt(moved) < MOVES) return null;
    const misses = Array.from({ length: LAG_MOST + 1 }, (_, shift) => off(shift));
    return 1000 * FRAME * misses.indexOf(Math.min(...misses));
  }

  /** All that is kept, a row a tick, with units in the header. */
  get csv() {
    const names = /** @type {(keyof Sample)[]} */ (Object.keys(this.samples[0] ?? {}));
    const header = names.map((name) => {
      const words = name.split(/(?=[A-Z])/).map((word) => word.toLowerCase());
      return [...words, UNITS[words[0]]].join("_");
    });
    const rows = this.samples.map((sample) => names.map((name) => sample[name].toFixed(4)));
    return [header, ...rows].map((row) => row.join(",")).join("\n") + "\n";
  }
}

/** Mean square of what lies between. @param {number[]} a @param {number[]} b */
const apart = (a, b) => a.reduce((sum, v, i) => sum + (v - b[i]) ** 2, 0) / a.length;

/** @template T @param {T[]} list @param {number} most @param {T} item */
function keep(list, most, item) {
  list.push(item);
  if (list.length > most) list.shift();
}
