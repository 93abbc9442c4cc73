// The framed 3-D view: captions over the figures, cameras, dark and light.
// viser publishes its internals as `__viserMutable` for tests; where they are missing the view
// still works, without captions and cameras.

import { stand, place } from "./cameras.js";
import { $, $$, press, setStyle } from "./dom.js";

/** @import { CameraName } from "./cameras.js" */
/** @import { Viser, ViewWindow } from "../types/page.js" */

const DRAGS = /** @type {const} */ (["dragenter", "dragover", "dragleave", "drop"]);

export class View {
  #frame = /** @type {HTMLIFrameElement} */ ($("#view"));
  #captions = $$(".caption");
  /** @type {Map<HTMLElement, [number, number]>} */
  #sizes = new Map();
  /** @type {CameraName} */
  #camera = "front";
  #connected = false;

  /**
   * @param {{ listen: (target: Window) => void, ready: () => void,
   *   drag: (event: DragEvent) => void }} hooks ready: once the figures are drawn
   */
  constructor({ listen, ready, drag }) {
    this.#frame.addEventListener("load", () => {
      const inner = this.#window;
      listen(inner);
      this.theme();
      // The view's canvas takes files as well, and must not open them in its frame.
      for (const kind of DRAGS) inner.addEventListener(kind, drag);
    });
    this.#frame.src = "/view/";
    for (const button of $$(".cameras button"))
      button.addEventListener("click", () =>
        this.look(/** @type {CameraName} */ (button.dataset.camera)),
      );
    new ResizeObserver(() => {
      this.#sizes.clear();
      if (this.#connected) this.look(this.#camera, false);
    }).observe(this.#frame);
    let shown = false;
    const each = () => {
      const viser = this.#inside;
      this.#connected = viser !== null && this.#place(viser);
      if (viser && this.#connected && !shown) {
        shown = true;
        this.look(this.#camera, false);
        this.#spare(viser);
        ready();
      }
      requestAnimationFrame(each);
    };
    requestAnimationFrame(each);
  }

  get #window() {
    return /** @type {ViewWindow} */ (this.#frame.contentWindow);
  }

  /** viser's own state, once its frame has loaded. @returns {Viser | null} */
  get #inside() {
    return this.#window?.__viserMutable ?? null;
  }

  /** Load the view anew, unless it is up. */
  reload() {
    if (!this.#inside || !this.#connected) this.#frame.src = "/view/";
  }

  /** The frame is as dark or light as the page. */
  theme() {
    const root = this.#frame.contentDocument?.documentElement;
    if (root) root.dataset.theme = document.documentElement.dataset.theme;
  }

  /** @param {CameraName} name @param {boolean} [glide] */
  look(name, glide = true) {
    const viser = this.#inside;
    if (!viser?.cameraControl) return;
    this.#camera = name;
    const { eye, at } = stand(name, this.#frame.clientWidth / this.#frame.clientHeight);
    const [from, to] = [eye, at].map((point) => toThree(viser, point));
    viser.cameraControl.setLookAt(from.x, from.y, from.z, to.x, to.y, to.z, glide);
    viser.requestRender();
    press($(".cameras"), "camera", name);
  }

  /**
   * Without a graphics card every pixel is work for the processor, which the robot needs: draw
   * half as fine, without shadows.
   *
   * @param {Viser} viser
   */
  #spare({ canvas, scene }) {
    const context = canvas.getContext("webgl2");
    const named = context?.getExtension("WEBGL_debug_renderer_info");
    const renderer = named ? context?.getParameter(named.UNMASKED_RENDERER_WEBGL) : "";
    if (!/swiftshader|llvmpipe|software|basic render/i.test(renderer)) return;
    this.#window.__viserTestpoints?.devSettings.set({ fixedDpr: 0.5 * devicePixelRatio });
    scene.traverse((thing) => {
      if (thing.isLight) thing.castShadow = false;
    });
  }

  /**
   * Runs every frame: reads no layout it has just changed, and writes only what moved. Whether
   * all three figures are there.
   *
   * @param {Viser} viser
   */
  #place({ camera, nodeRefFromName }) {
    if (!camera || !nodeRefFromName) return false;
    let found = 0;
    for (const node of this.#captions) {
      const anchor = nodeRefFromName[`/captions/${node.dataset.figure}`];
      if (!anchor) continue;
      found += 1;
      const point = anchor.getWorldPosition(anchor.position.clone()).project(camera);
      const at = place(point, this.#size(this.#frame), this.#size(node));
      const transform = at
        ? `translate(${at.left.toFixed(1)}px, ${at.top.toFixed(1)}px) translate(-50%, -100%)`
        : "";
      if (node.dataset.at === transform) continue;
      node.dataset.at = transform;
      setStyle(node, { transform, visibility: at ? "visible" : "hidden" });
    }
    return found === 3;
  }

  /** @param {HTMLElement} node @returns {[number, number]} */
  #size(node) {
    const known = this.#sizes.get(node) ?? [node.offsetWidth, node.offsetHeight];
    this.#sizes.set(node, known);
    return known;
  }

  /** What stands under each figure's name. @param {Record<string, string>} words */
  caption(words) {
    for (const node of this.#captions) {
      const line = $("span", node);
      const word = words[node.dataset.figure ?? ""] ?? "";
      if (line.textContent === word) continue;
      line.textContent = word;
      this.#sizes.delete(node);
    }
  }
}

/**
 * viser's world is z up, three.js' is y up: (x, y, z) is drawn at (x', y', z') = turn(x, y, z).
 *
 * @param {Viser} viser
 * @param {number[]} point
 */
function toThree({ camera, nodeRefFromName }, [x, y, z]) {
  const point = Object.assign(camera.position.clone(), { x, y, z });
  return nodeRefFromName[""]?.localToWorld(point) ?? point;
}
