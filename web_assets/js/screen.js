// Between the 3-D view and the pixels of the screen.

import { toThree } from "./view-camera.js";

/** @import { Rect } from "./panes.js" */
/** @import { Camera3D, Viser } from "../types/page.js" */

/** A camera, and where its picture is. @typedef {{ camera: Camera3D, at: Rect }} Pane */

/**
 * A point (m, z up) on the screen, px.
 *
 * @param {Viser} viser @param {Pane} pane @param {number[]} point
 * @returns {[number, number]}
 */
export function onScreen(viser, { camera, at }, point) {
  const { x, y } = toThree(viser, point).project(camera);
  return [at.x + ((x + 1) / 2) * at.width, at.y + ((1 - y) / 2) * at.height];
}

/**
 * Where whoever looks at a pixel looks on a level plane, x, y in m, z up.
 *
 * @param {Viser} viser @param {Pane} pane @param {[number, number]} pixel
 * @param {number} height m @param {number} [beyond] as of `meets`
 */
export function onPlane({ nodeRefFromName }, { camera, at }, [px, py], height, beyond) {
  const root = nodeRefFromName[""];
  if (!root) return [NaN, NaN];
  const [x, y] = [(2 * (px - at.x)) / at.width - 1, 1 - (2 * (py - at.y)) / at.height];
  const through = Object.assign(camera.position.clone(), { x, y, z: 0.5 }).unproject(camera);
  const [eye, to] = [camera.position.clone(), through].map((p) => root.worldToLocal(p).toArray());
  return meets(eye, to, height, beyond);
}

/**
 * Where a ray from an eye through a point meets the level plane of a height: x, y. One that does
 * not goes so far (m), to NaN by default.
 *
 * @param {number[]} eye @param {number[]} through @param {number} height @param {number} [beyond]
 */
export function meets(eye, through, height, beyond = NaN) {
  const way = through.map((c, i) => c - eye[i]);
  const far = (height - eye[2]) / way[2];
  const reach = Number.isFinite(far) && far > 0 ? far : beyond / Math.hypot(...way);
  return [eye[0] + reach * way[0], eye[1] + reach * way[1]];
}
