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
/** Between two looks for the lag, in ticks. */
const LAG_EVERY = 6;

/**
 * Plots by name: a title, a unit, decimals, and the curves' names in a sample, which are those of
 * `GET /api/takes/{name}/series`, too.
 *
 * @type {Record<string, { title: string, unit: string, digits: number,
 *   curves: [string, string][] }>}
 */
export const PLOTS = {
  speed: { title: "Speed", unit: "m/s", digits: 2, curves: pair("speed", "m_s") },
  turn: { title: "Turn", unit: "°/s", digits: 0, curves: pair("turn", "deg_s") },
  roll: { title: "Tilt sideways", unit: "°", digits: 1, curves: pair("roll", "deg") },
  pitch: { title: "Tilt forward", unit: "°", digits: 1, curves: pair("pitch", "deg") },
  height: { title: "Trunk height", unit: "cm", digits: 1, curves: pair("height", "cm") },
  paws: {
    title: "Front paws' height",
    unit: "cm",
    digits: 1,
    curves: [
      ["paw_right_cm", "right"],
      ["paw_left_cm", "left"],
    ],
  },
  error: {
    title: "Joint error, RMS",
    unit: "°",
    digits: 1,
    curves: [["joint_error_deg", "between asked and done"]],
  },
  lag: {
    title: "Joints' lag",
    unit: "ms",
    digits: 0,
    curves: [["joints_late_ms", "behind those asked for"]],
  },
};

/** Every signal, in the order of its plots. */
const NAMES = Object.values(PLOTS).flatMap(({ curves }) => curves.map(([name]) => name));

/**
 * One tick: t_s, and each signal in the unit that its name ends with; null where there is none.
 *
 * @typedef {Record<string, number | null>} Sample
 */

/** @param {string} name @param {string} unit @returns {[string, string][]} */
function pair(name, unit) {
  return [
    [`${name}_asked_${unit}`, "asked"],
    [`${name}_done_${unit}`, "done"],
  ];
}

/**
 * A row a time, with units in the header; nothing where there is no value.
 *
 * @param {number[]} t s
 * @param {(name: string) => (number | null | undefined)[]} values by signal
 */
export function csv(t, values) {
  const columns = [t, ...NAMES.map(values)];
  const rows = t.map((_, i) => columns.map((column) => column[i]?.toFixed(4) ?? ""));
  return [["t_s", ...NAMES], ...rows].map((row) => row.join(",")).join("\n") + "\n";
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
  /** ms, of when it was last looked for. @type {number | null} */
  #late = null;

  /** @param {Pick<Tick, "index" | "t" | "reference" | "robot">} tick */
  add({ index, t, reference, robot }) {
    if (index <= this.#index) this.clear(); // another run: a loop that catches up repeats times
    this.#index = index;
    const [asked, done] = [reference.base_quat, robot.base_quat].map(angles);
    const forward = (/** @type {number[]} */ v, /** @type {number} */ yaw) =>
      v[0] * Math.cos(yaw) + v[1] * Math.sin(yaw);
    const before = this.#yaws.at(-TURN_OVER);
    const since = this.samples.at(-TURN_OVER)?.t_s ?? t;
    const turn = (/** @type {number} */ now, /** @type {number | undefined} */ then) =>
      then === undefined || t <= since ? 0 : (DEG * shortest(now - then)) / (t - since);
    const misses = reference.joint_pos.map((q, i) => (q - robot.joint_pos[i]) ** 2);
    keep(this.#joints, LAG_OVER + LAG_MOST, [reference.joint_pos, robot.joint_pos]);
    if (index % LAG_EVERY === 0) this.#late = this.lag;
    keep(this.samples, HISTORY, {
      t_s: t,
      speed_asked_m_s: forward(reference.base_lin_vel_w, asked.yaw),
      speed_done_m_s: forward(robot.base_lin_vel_w, done.yaw),
      turn_asked_deg_s: turn(asked.yaw, before?.[0]),
      turn_done_deg_s: turn(done.yaw, before?.[1]),
      roll_asked_deg: DEG * asked.roll,
      roll_done_deg: DEG * done.roll,
      pitch_asked_deg: DEG * asked.pitch,
      pitch_done_deg: DEG * done.pitch,
      height_asked_cm: 100 * reference.base_pos[2],
      height_done_cm: 100 * robot.base_pos[2],
      paw_right_cm: 100 * robot.foot_pos_w[0][2],
      paw_left_cm: 100 * robot.foot_pos_w[1][2],
      joint_error_deg: DEG * Math.sqrt(misses.reduce((sum, e) => sum + e, 0) / misses.length),
      joints_late_ms: this.#late,
    });
    keep(this.#yaws, TURN_OVER, [asked.yaw, done.yaw]);
  }

  clear() {
    this.#late = null;
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

  /** s of each sample; those of another run never mix with these. */
  get times() {
    return this.samples.map(({ t_s }) => t_s ?? 0);
  }

  /** One signal over all that is kept. @param {string} name */
  of = (name) => this.samples.map((sample) => sample[name]);
}

/** Mean square of what lies between. @param {number[]} a @param {number[]} b */
const apart = (a, b) => a.reduce((sum, v, i) => sum + (v - b[i]) ** 2, 0) / a.length;

/** @template T @param {T[]} list @param {number} most @param {T} item */
function keep(list, most, item) {
  list.push(item);
  if (list.length > most) list.shift();
}
