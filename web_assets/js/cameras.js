// Where the cameras stand, and where a caption goes: geometry without a page.

/** @typedef {"front" | "side" | "behind" | "top" | "chase" | "split"} CameraName */
/** @import { Rect } from "./panes.js" */
/** @typedef {"human" | "reference" | "robot"} Figure */

/**
 * Direction from which a camera looks, its distance (m), and at what; in viser's world, z up.
 * places: where figures stand for it (x, y in m), if not in their columns; null: not shown.
 *
 * @type {Record<CameraName, { from: number[], at: number[],
 *   places?: Record<Figure, [number, number] | null> }>}
 */
const CAMERAS = {
  front: { from: [3.05, -1.15, 0.95], at: [0, -0.03, 0.4] },
  // In a row, so that none hides another.
  side: {
    from: [0, -4, 0.9],
    at: [0, 0, 0.42],
    places: { human: [-1.25, 0], reference: [-0.1, 0], robot: [1.1, 0] },
  },
  behind: { from: [-3.2, -0.5, 1.3], at: [0, 0, 0.42] },
  top: { from: [0.6, 0, 3.9], at: [0, 0, 0] },
  chase: {
    from: [-1.9, 0, 0.85],
    at: [0, 0, 0.3],
    places: { human: null, reference: null, robot: [0, 0] },
  },
  // The robots' half: the person is seen by a camera beside it (`panes.js`), and stands aside.
  split: {
    from: [3.4, -0.9, 1.1],
    at: [0, 0, 0.3],
    places: { human: [0, -1.9], reference: [0, -0.42], robot: [0, 0.42] },
  },
};
/** Width over height; narrower views step back, so that all three figures stay in sight. */
const WIDE = 1.75;
/** Of the split view, in which two robots have half of it. */
const HALF_WIDE = 0.95;
/** The figures stand that much wider beside props. */
const APART = 1.35;
/** Half of viser's angle of view, upright, as a tangent. */
const HALF = Math.tan(0.25);

/** px: lower views look this much (m) higher, so that captions fit between head and buttons. */
const LOW = 640;
const LIFT = 0.21;
const LOWEST = 480;

/**
 * Eye and target (m) of a camera in a view of that aspect, and how far (m) it is moved to the left
 * so that all is seen beside what covers a share of the view's left.
 *
 * @param {CameraName} name
 * @param {number} aspect
 * @param {boolean} [props] whether the figures stand beside props
 * @param {number} [covered] from 0 to 1
 * @param {number} [height] px
 */
export function stand(name, aspect, props = false, covered = 0, height = LOW) {
  const { from, at, places } = CAMERAS[name];
  const room = aspect * (1 - covered);
  const wide = name === "split" ? HALF_WIDE : WIDE;
  const narrow = name === "chase" ? 1 : Math.max(1, wide / room);
  const back = narrow * (props && !places ? APART : 1);
  const short = Math.min(1, Math.max(0, (LOW - height) / (LOW - LOWEST)));
  const to = [at[0], at[1], at[2] + back * LIFT * short];
  const eye = to.map((c, i) => c + back * from[i]);
  return { eye, at: to, aside: covered * back * Math.hypot(...from) * HALF * aspect };
}

/**
 * Where a figure stands for a camera, m; undefined for its column, null where it is not shown.
 *
 * @param {CameraName} name @param {Figure} figure
 */
export const placeOf = (name, figure) => CAMERAS[name].places?.[figure];

/**
 * How far (x, y in m) a figure that is turned by so much (rad) about the middle of everything is
 * moved for its column to come to a place.
 *
 * @param {[number, number]} column @param {[number, number]} place @param {number} turn
 * @returns {[number, number]}
 */
export function laid([x, y], place, turn) {
  const [c, s] = [Math.cos(turn), Math.sin(turn)];
  return [place[0] - (c * x - s * y), place[1] - (s * x + c * y)];
}

/** The turn (rad) from one heading to another, the short way. @param {number} turn */
export const wrapped = (turn) => Math.atan2(Math.sin(turn), Math.cos(turn));

/** s in which a chasing camera comes up with most of a turn. */
const BEHIND = 0.5;
/** rad: whoever wants no motion is cut to a new place after a turn of as much. */
const CUT = Math.PI / 4;

/**
 * How far (rad) a chasing camera turns in dt s towards a heading that is so far off.
 *
 * @param {number} off rad @param {number} dt s @param {boolean} cuts
 */
export function turnBy(off, dt, cuts) {
  if (cuts) return Math.abs(off) > CUT ? off : 0;
  return off * (1 - Math.exp(-dt / BEHIND));
}

/** px left free below a caption for what stands at the view's foot. */
const FOOT = 70;
/** px between captions, and between one and what stands at the view's edges. */
const GAP = 4;

/**
 * Where a caption's lower middle goes, px, kept inside the view; null where its figure is not
 * before the camera.
 *
 * @param {{ x: number, y: number }} point of the figure, in the view's coordinates from -1 to 1
 * @param {Rect} view its part of the page, px
 * @param {[number, number]} caption px
 */
export function place({ x, y }, view, [width, height]) {
  // A camera that has not looked yet answers NaN.
  if (!(Math.abs(x) < 1.1 && Math.abs(y) < 1.2)) return null;
  const half = width / 2 + 6;
  return {
    left: view.x + Math.min(view.width - half, Math.max(half, ((x + 1) / 2) * view.width)),
    top: view.y + Math.min(view.height - FOOT, Math.max(height + 6, ((1 - y) / 2) * view.height)),
  };
}

/**
 * What a figure takes up on the screen, from its caption's point down to the floor below; null
 * from above, where that says nothing.
 *
 * @param {{ x: number, y: number }} top in the view's coordinates @param {{ y: number }} floor
 * @param {Rect} view px @param {boolean} upright
 * @returns {Box | null}
 */
export function body(top, floor, view, upright) {
  const [x, high, low] = [top.x + 1, 1 - top.y, 1 - floor.y].map((c) => c / 2);
  const tall = (low - high) * view.height;
  if (!(tall > 30)) return null;
  const [middle, half] = [view.x + x * view.width, (upright ? 0.2 : 0.6) * tall];
  return {
    left: middle - half,
    right: middle + half,
    top: view.y + high * view.height + 1,
    bottom: view.y + low * view.height + 0.05 * tall, // toes
  };
}

/**
 * px: a box's edges.
 *
 * @typedef {{ left: number, top: number, right: number, bottom: number }} Box
 */

/**
 * Captions where none lies over another, or over what must stay free: each stays or goes up or
 * down as little as it can; null for one for which there is no room.
 *
 * @param {{ left: number, top: number, size: [number, number] }[]} captions as `place` gives them
 * @param {Box[]} kept what must stay free
 * @param {number} viewHeight px
 */
export function spread(captions, kept, viewHeight) {
  const taken = [...kept];
  return captions.map(({ left, top, size: [width, height] }) => {
    const at = (/** @type {number} */ bottom) => ({
      left: left - width / 2,
      right: left + width / 2,
      top: bottom - height,
      bottom,
    });
    const free = (/** @type {Box} */ box) =>
      box.top >= GAP && box.bottom <= viewHeight && !taken.some((other) => over(box, other));
    const ways = taken.flatMap((box) => [box.top - GAP, box.bottom + GAP + height]);
    const near = [top, ...ways].toSorted((a, b) => Math.abs(a - top) - Math.abs(b - top));
    const found = near.find((bottom) => free(at(bottom)));
    if (found === undefined) return null;
    taken.push(at(found));
    return { left, top: found };
  });
}

/** @param {Box} a @param {Box} b */
const over = (a, b) =>
  a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
