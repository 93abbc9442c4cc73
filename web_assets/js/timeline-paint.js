// The timeline's drawing: curves of the person and of what was shown, contacts, trim, flaws, now.

/** @import { Curves, Suggestion } from "../types/page.js" */

/**
 * @typedef {object} Paper
 * @property {CanvasRenderingContext2D} pen
 * @property {(name: string) => string} colour by its name in the theme
 * @property {Scale} scale
 * @property {number} height px
 */

const LANES = [
  ["roll", "Lean"],
  ["pitch", "Bend"],
  ["yaw", "Twist"],
  ["height", "Height"],
  ["right", "Right arm"],
  ["left", "Left arm"],
  ["step", "Steps"],
];
const PAWS = 4;
const LEFT = 74;
const RIGHT = 12;
const TOP = 20;
const PAW = 6;
const GAPS = [0.1, 0.2, 0.5, 1, 2, 5, 10, 30, 60, 300, 600, 1200];

/** Times (s) of a take to places (px) across a canvas, and back. */
export class Scale {
  /** @param {number} seconds @param {number} width px */
  constructor(seconds, width) {
    this.seconds = seconds;
    this.width = width;
    this.span = width - LEFT - RIGHT;
  }

  /** @param {number} t s */
  x(t) {
    return LEFT + (t / this.seconds) * this.span;
  }

  /** Within the take. @param {number} x px */
  t(x) {
    return Math.max(0, Math.min(this.seconds, ((x - LEFT) / this.span) * this.seconds));
  }

  /** s between two marks of the ruler: round, and no closer than their words are wide. */
  get gap() {
    const rough = this.seconds / Math.max(2, (this.width - LEFT) / 90);
    return GAPS.find((gap) => gap >= rough) ?? GAPS[GAPS.length - 1];
  }
}

/** @param {Paper} paper @param {Curves} data */
export function paintCurves(paper, data) {
  const { pen, colour, scale, height } = paper;
  pen.font = "11px system-ui, sans-serif";
  paintRuler(paper);
  const bottom = height - PAWS * PAW - 8;
  const lane = (bottom - TOP) / LANES.length;
  LANES.forEach(([name, title], i) => {
    const middle = TOP + (i + 0.5) * lane;
    const channel = data.channels.indexOf(name);
    pen.fillStyle = colour("muted");
    pen.fillText(title, 10, middle + 4);
    pen.strokeStyle = colour("line");
    const edge = scale.width - RIGHT;
    path(pen, 1, [LEFT, middle], [edge, middle]);
    if (channel < 0) return;
    const robot = data.robot.map((row) => row[channel] ?? 0);
    const human = data.human.map((row) => row[channel] ?? 0);
    const most = [...robot, ...human].reduce((high, v) => Math.max(high, Math.abs(v)), 1);
    const y = (/** @type {number} */ value) => middle - (0.46 * lane * value) / most;
    for (const [values, paint] of /** @type {const} */ ([
      [robot, "reference"],
      [human, "human"],
    ])) {
      pen.strokeStyle = colour(paint);
      path(pen, 1.6, ...data.t.map((t, j) => /** @type {Point} */ ([scale.x(t), y(values[j])])));
    }
  });
  pen.fillStyle = colour("good");
  for (let paw = 0; paw < PAWS; paw += 1) {
    const y = bottom + 4 + paw * PAW;
    const down = data.contact.map((row) => row[paw] >= 0.5);
    for (const [start, end] of stretches(down)) {
      const x = scale.x(data.t[start]);
      pen.fillRect(x, y, Math.max(1, scale.x(data.t[end]) - x), PAW - 2);
    }
  }
  pen.fillStyle = colour("muted");
  pen.fillText("Paws down", 10, bottom + 4 + 2 * PAW + 3);
}

/**
 * First and last index of each run of true, the last being the one after it where there is one.
 *
 * @param {boolean[]} flags
 */
export function stretches(flags) {
  /** @type {[number, number][]} */
  const found = [];
  let start = -1;
  flags.forEach((flag, i) => {
    if (flag && start < 0) start = i;
    if (start >= 0 && (!flag || i === flags.length - 1)) {
      found.push([start, i]);
      start = -1;
    }
  });
  return found;
}

/** @param {Paper} paper */
function paintRuler({ pen, colour, scale, height }) {
  pen.fillStyle = colour("muted");
  for (let t = 0; t <= scale.seconds + 1e-6; t += scale.gap) {
    pen.fillText(`${+t.toFixed(1)} s`, scale.x(t) + 3, 12);
    pen.strokeStyle = colour("line");
    path(pen, 0.6, [scale.x(t), 4], [scale.x(t), height]);
  }
}

/**
 * @param {Paper} paper
 * @param {{ trim: [number, number], cuts: [number, number][], flaws: Suggestion[],
 *   now: number }} marks s
 */
export function paintMarks({ pen, colour, scale, height }, { trim, cuts, flaws, now }) {
  pen.globalAlpha = 0.3;
  pen.fillStyle = colour("warn");
  for (const flaw of flaws) {
    const x = scale.x(flaw.start);
    pen.fillRect(x, TOP, Math.max(3, scale.x(flaw.end) - x), height - TOP);
  }
  pen.fillStyle = colour("bad");
  for (const [from, to] of cuts) {
    const x = scale.x(from);
    pen.fillRect(x, TOP, scale.x(to) - x, height - TOP);
  }
  pen.globalAlpha = 0.62;
  pen.fillStyle = colour("bg-2");
  const [start, end] = trim.map((t) => scale.x(t));
  pen.fillRect(LEFT, 0, start - LEFT, height);
  pen.fillRect(end, 0, scale.width - end, height);
  pen.globalAlpha = 1;
  pen.fillStyle = colour("accent");
  for (const [x, handle] of [
    [start, start - 9],
    [end, end],
  ]) {
    pen.fillRect(x - 1, 0, 2, height);
    pen.beginPath();
    pen.roundRect(handle, 0, 9, 18, 3);
    pen.fill();
  }
  const x = scale.x(now);
  pen.fillStyle = colour("text");
  pen.fillRect(x - 0.75, 0, 1.5, height);
  pen.beginPath();
  pen.arc(x, TOP - 4, 4.5, 0, 7);
  pen.fill();
}

/** @typedef {[number, number]} Point */

/** @param {CanvasRenderingContext2D} pen @param {number} width @param {...Point} points */
function path(pen, width, ...points) {
  pen.lineWidth = width;
  pen.beginPath();
  points.forEach(([x, y], i) => (i ? pen.lineTo(x, y) : pen.moveTo(x, y)));
  pen.stroke();
}
