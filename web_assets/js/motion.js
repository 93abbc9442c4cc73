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

/** A vector turned by a quaternion w, x, y, z. @param {number[]} quat @param {number[]} v */
export function turned([w, x, y, z], [a, b, c]) {
  const [p, q, r] = [y * c - z * b, z * a - x * c, x * b - y * a];
  return [
    a + 2 * (w * p + y * r - z * q),
    b + 2 * (w * q + z * p - x * r),
    c + 2 * (w * r + x * q - y * p),
  ];
}
