// Inside the framed 3-D view, before viser's own script. Its bundle prepares a sorter for Gaussian
// splats that wants eval; our policy forbids eval, we show no splats, and the refusal is harmless.

/** @param {ErrorEvent | PromiseRejectionEvent} event */
function harmless(event) {
  const error = "reason" in event ? event.reason : event.error;
  if (error instanceof EvalError) event.preventDefault();
}

addEventListener("unhandledrejection", harmless, true);
addEventListener("error", harmless, true);

/** Without a graphics card four samples a pixel take as long as all else together. Who draws is
 * known before viser asks for its canvas; afterwards its samples cannot be changed. */
function drawnInSoftware() {
  const context = document.createElement("canvas").getContext("webgl2", { antialias: false });
  const named = context?.getExtension("WEBGL_debug_renderer_info");
  const renderer = named ? `${context?.getParameter(named.UNMASKED_RENDERER_WEBGL)}` : "";
  context?.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|software|basic render/i.test(renderer);
}

/** @type {import("../types/page.js").ViewWindow} */ (window).drawnInSoftware = drawnInSoftware();
if (/** @type {import("../types/page.js").ViewWindow} */ (window).drawnInSoftware) {
  /** @type {any} */
  const canvases = HTMLCanvasElement.prototype;
  const get = canvases.getContext;
  /** @this {HTMLCanvasElement} @param {string} kind @param {object} [settings] */
  canvases.getContext = function (kind, settings) {
    return get.call(this, kind, kind === "webgl2" ? { ...settings, antialias: false } : settings);
  };
}
