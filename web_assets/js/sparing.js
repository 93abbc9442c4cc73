// Drawing with little: what is left out where the processor draws, which the robot needs.

/** @import { Viser, ViewWindow } from "../types/page.js" */

/** ms that a frame is rested after at most. */
export const REST = 400;
/** Of the light from all around, which is there for this: as bright as the room's reflections. */
const FILL = 2.6;

/**
 * Without a graphics card (frame.js) every pixel is work for the processor: draw half as fine,
 * without shadows, reflections and an empty background, and rest after each frame for as long as
 * it took. Whether that is so.
 *
 * @param {Viser} viser @param {ViewWindow} window its own
 */
export function spare({ scene, backgroundMaterial }, window) {
  if (!window.drawnInSoftware) return false;
  window.__viserTestpoints?.devSettings.set({ fixedDpr: 0.5 * devicePixelRatio });
  Object.defineProperty(scene, "environment", { get: () => null, set: () => {} });
  scene.traverse((thing) => {
    if (thing.isLight) thing.castShadow = false;
    if (thing.isHemisphereLight) thing.intensity = FILL;
    if (backgroundMaterial && thing.material === backgroundMaterial) thing.visible = false;
  });
  rested(window);
  return true;
}

/**
 * A window's next frame is asked for only once half of the time has been left to others: how long
 * one takes is how long the window waits for it.
 *
 * @param {Window} window
 */
function rested(window) {
  const ask = window.requestAnimationFrame.bind(window);
  let rest = 0;
  window.requestAnimationFrame = (draw) =>
    window.setTimeout(() => {
      const asked = performance.now();
      ask((now) => {
        rest = Math.min(REST, 0.7 * rest + 0.3 * (performance.now() - asked));
        draw(now);
      });
    }, rest);
  window.cancelAnimationFrame = (handle) => window.clearTimeout(handle);
}
