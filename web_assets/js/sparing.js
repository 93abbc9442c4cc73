// Drawing with little: what is left out where the processor draws, which the robot needs.

/** @import { Viser, ViewWindow } from "../types/page.js" */

/** ms that a frame is rested after at most. */
export const REST = 400;

/**
 * Without a graphics card every pixel is work for the processor: draw half as fine, without
 * shadows, and rest after each frame for as long as it took. Whether that is so.
 *
 * @param {Viser} viser @param {ViewWindow} window its own
 */
export function spare({ canvas, scene }, window) {
  const context = canvas.getContext("webgl2");
  const named = context?.getExtension("WEBGL_debug_renderer_info");
  const renderer = named ? context?.getParameter(named.UNMASKED_RENDERER_WEBGL) : "";
  if (!/swiftshader|llvmpipe|software|basic render/i.test(renderer)) return false;
  window.__viserTestpoints?.devSettings.set({ fixedDpr: 0.5 * devicePixelRatio });
  scene.traverse((thing) => {
    if (thing.isLight) thing.castShadow = false;
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
