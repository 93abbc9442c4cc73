// What the pose model sees → what the person should change, and whether they stand quiet.

/** @typedef {[x: number, y: number, z: number, visibility: number]} Landmark */
/** What the worker saw in one picture: shares of the picture, and m around the middle of the hips.
 * @typedef {{ landmarks: Landmark[] | null, world: number[][] | null, people: number,
 *   light: number, ms: number, t: number }} Seen */

export const NOSE = 0;
export const [SHOULDERS, ELBOWS, WRISTS] = [
  [11, 12],
  [13, 14],
  [15, 16],
];
export const [HIPS, KNEES, ANKLES, TOES] = [
  [23, 24],
  [25, 26],
  [27, 28],
  [31, 32],
];
/** What the studio makes a person of. */
const BODY = [...SHOULDERS, ...ELBOWS, ...WRISTS, ...HIPS, ...KNEES, ...ANKLES];

const DARK = 40; // of 255, the picture's mean
const SURE = 0.5; // visibility
const EDGE = 0.01; // share of the picture
const SMALL = 0.35; // nose to ankles, as a share of the picture
const SIDEWAYS = 0.8; // how far apart in depth the shoulders are, against across

/** Mean visibility of what drives the robot, 0 to 1. @param {Landmark[] | null} landmarks */
export const confidence = (landmarks) =>
  landmarks ? BODY.reduce((sum, k) => sum + landmarks[k][3], 0) / BODY.length : 0;

/**
 * The first thing to change, or "" where all is well.
 *
 * @param {Pick<Seen, "landmarks" | "world" | "people" | "light">} seen
 */
export function advice({ landmarks, world, people, light }) {
  if (light < DARK) return "Too dark: turn on a light, or away from the window";
  if (!landmarks || !world) return "Nobody is seen: step into the picture";
  if (people > 1) return "Two people are seen: only one can drive";
  const unseen = (/** @type {number} */ k) => {
    const [x, y, , visibility] = landmarks[k];
    return visibility < SURE || Math.min(x, y, 1 - x, 1 - y) < EDGE;
  };
  if (unseen(NOSE)) return "Your head is not seen: step back, or tilt the camera";
  if ([...HIPS, ...KNEES].some(unseen)) return "Step back until all of you is in the picture";
  if (ANKLES.some(unseen)) return "Your feet are not seen: step back, or tilt the camera down";
  if ([...SHOULDERS, ...HIPS].some(unseen)) return "Move to the middle of the picture";
  const [left, right] = SHOULDERS.map((k) => world[k]);
  if (Math.abs(left[2] - right[2]) > SIDEWAYS * Math.abs(left[0] - right[0]))
    return "You stand sideways: face the camera";
  const feet = (landmarks[ANKLES[0]][1] + landmarks[ANKLES[1]][1]) / 2;
  if (feet - landmarks[NOSE][1] < SMALL && upright(world)) return "Come closer";
  return "";
}

/** Whether the legs are straight and under the trunk: y points down. @param {number[][]} world */
function upright(world) {
  const hips = (world[HIPS[0]][1] + world[HIPS[1]][1]) / 2;
  const [shoulders, ankles] = [SHOULDERS, ANKLES].map(([l, r]) => (world[l][1] + world[r][1]) / 2);
  return hips - shoulders > 0.35 && ankles - hips > 0.6;
}

const QUIET_FOR = 1.5; // s
const SETTLING = 0.4; // s, of the mean that joints are held against
const MOVED = 0.07; // m from it: landmarks jitter by some 0.02

/** How long a person has stood upright and quiet. */
export class Quiet {
  /** @type {number[][] | null} */
  #mean = null;
  #at = 0;
  #since = 0;

  /** What was seen so far is forgotten. */
  reset() {
    this.#mean = null;
  }

  /**
   * How far the ring is filled, 0 to 1, with what was seen at t (s).
   *
   * @param {number[][] | null} world
   * @param {number} t
   * @param {boolean} framed whether nothing else is to be changed
   */
  push(world, t, framed) {
    if (!world || !framed || !upright(world) || t - this.#at > 1) this.#mean = null;
    const step = t - this.#at;
    this.#at = t;
    if (!world) return 0;
    const mean = (this.#mean ??= ((this.#since = t), world.map((joint) => [...joint])));
    if (!framed || !upright(world)) return this.#begin(t);
    const share = 1 - Math.exp(-Math.max(0, step) / SETTLING);
    let far = 0;
    for (const k of BODY) {
      far = Math.max(far, Math.hypot(...mean[k].map((v, i) => v - world[k][i])));
      mean[k] = mean[k].map((v, i) => v + share * (world[k][i] - v));
    }
    if (far > MOVED) return this.#begin(t);
    return Math.min(1, (t - this.#since) / QUIET_FOR);
  }

  /** @param {number} t */
  #begin(t) {
    this.#since = t;
    return 0;
  }
}
