// Where the cameras stand, and where a caption goes: geometry without a page.

/** @typedef {"front" | "side" | "behind" | "top"} CameraName */

/**
 * Direction from which a camera looks, its distance (m), and at what; in viser's world, z up.
 *
 * @type {Record<CameraName, { from: number[], at: number[] }>}
 */
const CAMERAS = {
  front: { from: [3.05, -1.15, 0.95], at: [0, -0.03, 0.4] },
  side: { from: [1.1, -3.6, 0.8], at: [0, 0, 0.4] },
  behind: { from: [-3.2, -0.5, 1.3], at: [0, 0, 0.42] },
  top: { from: [0.6, 0, 3.9], at: [0, 0, 0] },
};
/** Width over height; narrower views step back, so that all three figures stay in sight. */
const WIDE = 1.75;
/** px left free below a caption for what stands at the view's foot. */
const FOOT = 70;
/** px between captions, and between one and what stands at the view's edges. */
const GAP = 4;

/** The figures stand that much wider beside props. */
const APART = 1.35;

/**
 * Eye and target (m) of a camera in a view of that aspect.
 *
 * @param {CameraName} name
 * @param {number} aspect
 * @param {boolean} [props] whether the figures stand beside props
 */
export function stand(name, aspect, props = false) {
  const { from, at } = CAMERAS[name];
  const back = Math.max(1, WIDE / aspect) * (props ? APART : 1);
  return { eye: at.map((c, i) => c + back * from[i]), at };
}

/**
 * Where a caption's lower middle goes, px, kept inside the view; null where its figure is not
 * before the camera.
 *
 * @param {{ x: number, y: number }} point of the figure, in the view's coordinates from -1 to 1
 * @param {[number, number]} view px
 * @param {[number, number]} caption px
 */
export function place({ x, y }, [viewWidth, viewHeight], [width, height]) {
  // A camera that has not looked yet answers NaN.
  if (!(Math.abs(x) < 1.1 && Math.abs(y) < 1.2)) return null;
  const half = width / 2 + 6;
  return {
    left: Math.min(viewWidth - half, Math.max(half, ((x + 1) / 2) * viewWidth)),
    top: Math.min(viewHeight - FOOT, Math.max(height + 6, ((1 - y) / 2) * viewHeight)),
  };
}

/**
 * px: a box's edges.
 *
 * @typedef {{ left: number, top: number, right: number, bottom: number }} Box
 */

/**
 * Captions where none lies over another, or over what must stay free: each stays or goes up or
 * down as little as it can.
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
    const found = near.find((bottom) => free(at(bottom))) ?? top;
    taken.push(at(found));
    return { left, top: found };
  });
}

/** @param {Box} a @param {Box} b */
const over = (a, b) =>
  a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
