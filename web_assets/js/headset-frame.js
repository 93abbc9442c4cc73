// What a headset tracks in one frame, as the studio's source `headset` takes it.

/** Joints of WebXR's Body Tracking module that the studio takes, as docs/contract.md has them. */
export const BODY = [
  "head",
  ...["left", "right"].flatMap((side) =>
    [
      ["arm-upper", "arm-lower", "hand-wrist"],
      ["upper-leg", "lower-leg", "foot-ankle", "foot-ball"],
    ]
      .flat()
      .map((part) => `${side}-${part}`),
  ),
];
const [AGAIN, STOP] = [4, 5]; // of a gamepad's buttons: A or X, and B or Y
const QUIET_FOR = 1.5; // s
const SETTLING = 0.4; // s, of the mean that head and hands are held against
const MOVED = 0.06; // m from it

/** @typedef {[x: number, y: number, z: number]} Place */
/** m in WebXR's axes, t in s; null what is not tracked.
 * @typedef {{ t: number, head: number[], left: Place | null, right: Place | null,
 *   stick: [number, number], body: (Place | null)[] | null }} Worn */

const short = (/** @type {number} */ v) => Math.round(v * 1e4) / 1e4;

/**
 * Where something is; null where that is not known, or only guessed by the headset.
 *
 * @param {XRFrame} frame @param {XRSpace | undefined} space @param {XRReferenceSpace} floor
 * @returns {Place | null}
 */
function place(frame, space, floor) {
  const pose = space && frame.getPose(space, floor);
  if (!pose || pose.emulatedPosition) return null;
  const { x, y, z } = pose.transform.position;
  return [short(x), short(y), short(z)];
}

/**
 * What is tracked at t (s); null where the head is not.
 *
 * @param {XRFrame} frame @param {XRReferenceSpace} floor @param {number} t
 * @returns {Worn | null}
 */
export function worn(frame, floor, t) {
  const pose = frame.getViewerPose(floor);
  if (!pose || pose.emulatedPosition) return null;
  const { position: p, orientation: q } = pose.transform;
  const inputs = [...frame.session.inputSources];
  const hand = (/** @type {string} */ side) => {
    const input = inputs.find(({ handedness }) => handedness === side);
    return input ? place(frame, input.hand?.get("wrist") ?? input.gripSpace, floor) : null;
  };
  const { body } = /** @type {{ body?: Map<string, XRSpace> }} */ (/** @type {unknown} */ (frame));
  return {
    t,
    head: [p.x, p.y, p.z, q.x, q.y, q.z, q.w].map(short),
    left: hand("left"),
    right: hand("right"),
    stick: stick(inputs),
    body: body ? BODY.map((name) => place(frame, body.get(name), floor)) : null,
  };
}

/** The stick that is pushed further, right and back. @param {XRInputSource[]} inputs */
function stick(inputs) {
  /** @type {[number, number]} */
  let furthest = [0, 0];
  for (const { gamepad } of inputs) {
    const [, , x = 0, y = 0] = gamepad?.axes ?? [];
    if (Math.hypot(x, y) > Math.hypot(...furthest)) furthest = [short(x), short(y)];
  }
  return furthest;
}

/** Buttons that mean something, if pressed. @param {XRFrame} frame */
export function pressed({ session }) {
  const held = (/** @type {number} */ k) =>
    [...session.inputSources].some(({ gamepad }) => gamepad?.buttons[k]?.pressed);
  return { stop: held(STOP), again: held(AGAIN) };
}

/** How long head and hands have kept still, the stick at rest. */
export class Still {
  /** @type {number[] | null} */
  #mean = null;
  #at = 0;
  #since = 0;

  /** What was seen so far is forgotten. */
  reset() {
    this.#mean = null;
  }

  /** How far the ring is filled, 0 to 1. @param {Worn} seen */
  push({ t, head, left, right, stick: [x, y] }) {
    const places = [head.slice(0, 3), left ?? [0, 0, 0], right ?? [0, 0, 0]].flat();
    if (!this.#mean || t - this.#at > 1) {
      this.#mean = places;
      this.#since = t;
    }
    const share = 1 - Math.exp(-Math.max(0, t - this.#at) / SETTLING);
    this.#at = t;
    const moved = places.some((v, k) => Math.abs(v - /** @type {any} */ (this.#mean)[k]) > MOVED);
    this.#mean = this.#mean.map((v, k) => v + share * (places[k] - v));
    if (moved || Math.hypot(x, y) > 0.1) this.#since = t;
    return Math.min(1, (t - this.#since) / QUIET_FOR);
  }
}
