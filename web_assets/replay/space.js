// Rotations, frames and the A1's legs, as column-major matrices for WebGL. z up, x ahead, metres.

/** @typedef {[number, number, number]} Vec */

/** A place and a turn (wxyz) and a scale as a matrix: p ↦ R(q) (s p) + t. */
/** @param {ArrayLike<number>} t @param {ArrayLike<number>} q @param {ArrayLike<number>} [s] */
export function placed(t, q, s = [1, 1, 1]) {
  const [w, x, y, z] = [q[0], q[1], q[2], q[3]];
  const rows = [
    [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
    [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
    [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
  ];
  const out = new Float32Array(16);
  for (let column = 0; column < 3; column++)
    for (let row = 0; row < 3; row++) out[4 * column + row] = rows[row][column] * s[column];
  out.set([t[0], t[1], t[2], 1], 12);
  return out;
}

/** a b @param {Float32Array} a @param {Float32Array} b */
export function times(a, b) {
  const out = new Float32Array(16);
  for (let column = 0; column < 4; column++)
    for (let row = 0; row < 4; row++)
      for (let k = 0; k < 4; k++) out[4 * column + row] += a[4 * k + row] * b[4 * column + k];
  return out;
}

/**
 * A matrix applied to a point: (x, y, z, w).
 *
 * @param {Float32Array} m
 * @param {ArrayLike<number>} p
 */
export const applied = (m, p) =>
  [0, 1, 2, 3].map((row) => m[row] * p[0] + m[4 + row] * p[1] + m[8 + row] * p[2] + m[12 + row]);

/** A turn about an axis (0 for x, 1 for y). @param {0 | 1} axis @param {number} angle rad */
const about = (axis, angle) => {
  const sin = Math.sin(angle / 2);
  return [Math.cos(angle / 2), axis === 0 ? sin : 0, axis === 1 ? sin : 0, 0];
};

/**
 * Where the 13 links are, trunk first, then hip, thigh and calf of each leg.
 *
 * @param {ArrayLike<number>} pos of the trunk
 * @param {ArrayLike<number>} quat
 * @param {ArrayLike<number>} joints 12 angles, rad
 * @param {{ hip: Vec[], thigh: Vec[], calf: Vec }} offsets of each joint in the link before
 */
export function links(pos, quat, joints, { hip, thigh, calf }) {
  const out = [placed(pos, quat)];
  for (let leg = 0; leg < 4; leg++) {
    const [a, b, c] = [joints[3 * leg], joints[3 * leg + 1], joints[3 * leg + 2]];
    const first = times(out[0], placed(hip[leg], about(0, a)));
    const second = times(first, placed(thigh[leg], about(1, b)));
    out.push(first, second, times(second, placed(calf, about(1, c))));
  }
  return out;
}

/**
 * A solid of unit length along z and unit radius, as a bone between two points.
 *
 * @param {ArrayLike<number>} from
 * @param {ArrayLike<number>} to
 * @param {number} across m, its radius one way
 * @param {number} deep and the other
 * @param {ArrayLike<number>} side about which way is across
 */
export function bone(from, to, across, deep, side) {
  const along = [0, 1, 2].map((i) => to[i] - from[i]);
  const length = Math.hypot(...along) || 1e-6;
  const z = along.map((v) => v / length);
  const dot = z[0] * side[0] + z[1] * side[1] + z[2] * side[2];
  let x = z.map((v, i) => side[i] - dot * v);
  const size = Math.hypot(...x);
  // What lies across the body itself: any direction will do.
  x = size < 0.3 * Math.hypot(side[0], side[1], side[2]) ? [-z[1], z[0], 0] : x;
  const unit = Math.hypot(...x) || 1;
  x = x.map((v) => v / unit);
  const y = [z[1] * x[2] - z[2] * x[1], z[2] * x[0] - z[0] * x[2], z[0] * x[1] - z[1] * x[0]];
  return new Float32Array([
    ...x.map((v) => v * across), 0, ...y.map((v) => v * deep), 0, ...along, 0,
    from[0], from[1], from[2], 1,
  ]); // prettier-ignore
}

/**
 * What a camera sees: from an angle about a point, a field of view of `fov` rad.
 *
 * @param {Vec} at
 * @param {number} yaw rad, 0 from ahead
 * @param {number} pitch rad
 * @param {number} far m from the point
 * @param {number} fov rad, of the height
 * @param {number} aspect
 */
export function camera(at, yaw, pitch, far, fov, aspect) {
  const back = [Math.cos(pitch) * Math.cos(yaw), Math.cos(pitch) * Math.sin(yaw), Math.sin(pitch)];
  const right = [-Math.sin(yaw), Math.cos(yaw), 0];
  const up = [-Math.sin(pitch) * Math.cos(yaw), -Math.sin(pitch) * Math.sin(yaw), Math.cos(pitch)];
  const eye = at.map((v, i) => v + far * back[i]);
  const from = (/** @type {number[]} */ axis) => -axis.reduce((sum, v, i) => sum + v * eye[i], 0);
  const view = new Float32Array(16);
  [right, up, back].forEach((axis, row) => {
    for (let column = 0; column < 3; column++) view[4 * column + row] = axis[column];
    view[12 + row] = from(axis);
  });
  view[15] = 1;
  const [near, end] = [0.05, 60];
  const f = 1 / Math.tan(fov / 2);
  const lens = new Float32Array(16);
  lens.set([f / aspect, 0, 0, 0, 0, f]);
  lens[10] = (end + near) / (near - end);
  lens[11] = -1;
  lens[14] = (2 * end * near) / (near - end);
  return times(lens, view);
}
