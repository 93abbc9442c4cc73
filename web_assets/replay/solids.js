// Solids as triangles with smooth normals: those of the file, balls, bones and discs.

/** @typedef {{ vertices: Float32Array, normals: Float32Array, faces: Uint16Array }} Solid */

/** Text of base64 as a typed array. */
/** @template T @param {string} text @param {{ new (buffer: ArrayBuffer): T }} Kind @returns {T} */
export function unpacked(text, Kind) {
  return new Kind(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer);
}

/**
 * With the normal of each vertex: the mean of its faces', the larger the more.
 *
 * @param {Float32Array} vertices
 * @param {Uint16Array} faces
 * @returns {Solid}
 */
export function solid(vertices, faces) {
  const normals = new Float32Array(vertices.length);
  for (let i = 0; i < faces.length; i += 3) {
    const corners = [faces[i], faces[i + 1], faces[i + 2]];
    const at = corners.map((v) => vertices.subarray(3 * v, 3 * v + 3));
    const u = [0, 1, 2].map((k) => at[1][k] - at[0][k]);
    const v = [0, 1, 2].map((k) => at[2][k] - at[0][k]);
    const n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    for (const corner of corners) for (let k = 0; k < 3; k++) normals[3 * corner + k] += n[k];
  }
  for (let i = 0; i < normals.length; i += 3) {
    const size = Math.hypot(normals[i], normals[i + 1], normals[i + 2]) || 1;
    for (let k = 0; k < 3; k++) normals[i + k] /= size;
  }
  return { vertices, normals, faces };
}

/**
 * Turned about z: rings of (radius, height), from below.
 *
 * @param {[number, number][]} profile
 * @param {number} segments
 */
export function revolved(profile, segments) {
  const vertices = profile.flatMap(([radius, z]) =>
    Array.from({ length: segments }, (_, i) => {
      const angle = (2 * Math.PI * i) / segments;
      return [radius * Math.cos(angle), radius * Math.sin(angle), z];
    }).flat(),
  );
  const faces = [];
  for (let ring = 0; ring + 1 < profile.length; ring++)
    for (let i = 0; i < segments; i++) {
      const [a, b] = [ring * segments + i, ring * segments + ((i + 1) % segments)];
      faces.push(a, b, b + segments, a, b + segments, a + segments);
    }
  return solid(new Float32Array(vertices), new Uint16Array(faces));
}

const EPS = 1e-3;

/** A ball of radius 1. */
export const ball = () =>
  revolved(
    Array.from({ length: 11 }, (_, i) => {
      const angle = Math.PI * (i / 10 - 0.5);
      return [Math.max(EPS, Math.cos(angle)), Math.sin(angle)];
    }),
    18,
  );

/** A limb from z = 0 to 1: fuller near its start, slimmer at its end. */
export const limb = () =>
  revolved(
    [
      [EPS, 0],
      [0.86, 0],
      [0.96, 0.12],
      [1, 0.32],
      [0.95, 0.6],
      [0.86, 0.85],
      [0.8, 1],
      [EPS, 1],
    ],
    16,
  );

/** A disc of radius 1 that lies flat. */
export const disc = () =>
  revolved(
    [
      [1, 0],
      [EPS, 0],
    ],
    24,
  );
