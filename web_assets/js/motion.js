// The control period, and how a body is turned: arithmetic without a page.

/** s: a control period. */
export const FRAME = 1 / 30;

/**
 * Roll, pitch and yaw (rad) of a quaternion w, x, y, z; yaw first.
 *
 * @param {number[]} quat
 */
export function angles([w, x, y, z]) {
  return {
    roll: Math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)),
    pitch: Math.asin(Math.max(-1, Math.min(1, 2 * (w * y - z * x)))),
    yaw: Math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)),
  };
}
