// The framed 3-D view: captions over the figures, cameras, dark and light.
// viser publishes its internals as `__viserMutable` for tests; where they are missing the view
// still works, without captions and cameras.

import { Besides } from "./besides.js";
import { body, place, spread } from "./cameras.js";
import { $, $$, setStyle, text } from "./dom.js";
import { Looks } from "./looks.js";
import { Panes } from "./panes.js";
import { REST, spare } from "./sparing.js";
import { ViewCamera } from "./view-camera.js";

const FULL = "Full view: drawn by the graphics card.";
const LIGHT = "Light view: drawn without a graphics card, coarser and without shadows.";

/** @import { Box, CameraName } from "./cameras.js" */
/** @import { Tick, Viser, ViewWindow } from "../types/page.js" */

/** What is at the view's edges. */
const EDGES =
  ".stage-record, .cameras, .looks, .scene-over, .eye, .coach, .coach-actions, .stopped";
const AGAIN = 250; // ms until it is looked for again
const DRAGS = /** @type {const} */ (["dragenter", "dragover", "dragleave", "drop"]);

export class View {
  #frame = /** @type {HTMLIFrameElement} */ ($("#view"));
  #captions = $$(".caption");
  /** @type {Map<HTMLElement, [number, number]>} */
  #sizes = new Map();
  /** @type {Box[]} */
  #edges = [];
  #looked = -Infinity;
  /** @type {ViewCamera} */
  #camera;
  #connected = false;
  #props = false;
  /** Whether the processor draws, and the captions need not follow any faster than that. */
  #spared = false;
  #looks = new Looks();
  panes = new Panes();
  /** @type {Besides} */
  besides;

  /**
   * @param {{ listen: (target: Window) => void, ready: () => void,
   *   drag: (event: DragEvent) => void, newest: () => Tick | null }} hooks ready: once the figures
   *   are drawn
   */
  constructor({ listen, ready, drag, newest }) {
    const camera = (this.#camera = new ViewCamera(newest, this.#looks, this.panes));
    const shows = (/** @type {string} */ figure) => camera.shows(figure);
    this.besides = new Besides(this.#looks, this.panes, { newest, shows });
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
    let width = 0;
    const resized = new ResizeObserver(() => {
      const [view, over] = [this.#frame, $("#scene-over")];
      if (width === (width = view.clientWidth + view.clientHeight + over.clientWidth)) return;
      this.#sizes.clear();
      if (this.#connected) this.look(this.#camera.name, false);
    });
    for (const node of [this.#frame, $("#scene-over")]) resized.observe(node);
    let shown = false;
    const each = () => {
      const viser = this.viser;
      this.#connected = viser !== null && this.#place(viser);
      if (viser && this.#connected && !shown) {
        shown = true;
        this.look(this.#camera.name, false);
        this.#spared = spare(viser, this.#window);
        text($("#drawn-by"), this.#spared ? LIGHT : FULL);
        ready();
      }
      if (this.#spared) setTimeout(() => requestAnimationFrame(each), REST / 4);
      else requestAnimationFrame(each);
    };
    requestAnimationFrame(each);
  }

  get #window() {
    return /** @type {ViewWindow} */ (this.#frame.contentWindow);
  }

  /** viser's own state, once its frame has loaded. @returns {Viser | null} */
  get viser() {
    return this.#window?.__viserMutable ?? null;
  }

  /** What viser draws on, with the words over it; null before it draws. */
  get picture() {
    const canvas = this.viser?.canvas;
    return canvas ? { canvas, captions: this.#captions } : null;
  }

  /** Load the view anew, unless it is up. */
  reload() {
    if (!this.viser || !this.#connected) this.#frame.src = "/view/";
  }

  /** The frame is as dark or light as the page. */
  theme() {
    const root = this.#frame.contentDocument?.documentElement;
    if (root) root.dataset.theme = document.documentElement.dataset.theme;
  }

  /** Whether there are props, beside which the figures stand wider. @param {boolean} props */
  beside(props) {
    if (props === this.#props) return;
    this.#props = props;
    this.look(this.#camera.name);
  }

  /** Cameras by key, in the order of their buttons. */
  keys = Object.fromEntries(
    $$(".cameras button").map((button, i) => [`${i + 1}`, () => button.click()]),
  );

  /** @param {CameraName} name @param {boolean} [glide] */
  look(name, glide = true) {
    const viser = this.viser;
    if (!viser?.cameraControl) return;
    this.#camera.name = name;
    const { clientWidth, clientHeight } = this.#frame;
    this.#camera.look(viser, [clientWidth, clientHeight], this.#props, glide);
  }

  /**
   * Runs every frame: reads no layout it has just changed, and writes only what moved. Whether
   * all three figures are there.
   *
   * @param {Viser} viser
   */
  #place(viser) {
    const { camera, nodeRefFromName } = viser;
    if (!camera || !nodeRefFromName) return false;
    if (this.#connected) {
      this.panes.draw(viser);
      this.#camera.follow(viser);
      this.besides.draw(viser);
    }
    const view = this.#size(this.#frame);
    let found = 0;
    /** @type {Box[]} */
    const bodies = [];
    const shown = this.#captions.flatMap((node) => {
      const figure = node.dataset.figure ?? "";
      const anchor = nodeRefFromName[`/${figure}/caption`];
      const root = nodeRefFromName[`/${figure}`];
      if (!anchor || !root) return [];
      found += 1;
      const pane = this.panes.of(viser, figure);
      const point = anchor.getWorldPosition(anchor.position.clone()).project(pane.camera);
      const size = this.#size(node);
      const at = this.#camera.shows(figure) ? place(point, pane.at, size) : null;
      if (!at) this.#put(node, "");
      if (!at) return [];
      const below = root.localToWorld(Object.assign(anchor.position.clone(), { z: 0 }));
      const box = body(point, below.project(pane.camera), pane.at, figure === "human");
      if (box) bodies.push(box);
      return [{ node, size, ...at }];
    });
    spread(shown, [...this.#kept, ...bodies], view[1]).forEach((at, i) => {
      const px = at && [at.left, at.top].map((c) => `${c.toFixed(1)}px`).join();
      this.#put(shown[i].node, px ? `translate(${px}) translate(-50%, -100%)` : "");
    });
    return found === 3;
  }

  /** @param {HTMLElement} node @param {string} transform "" for nowhere */
  #put(node, transform) {
    if (node.dataset.at === transform) return;
    node.dataset.at = transform;
    setStyle(node, { transform, visibility: transform ? "visible" : "hidden" });
  }

  /** What is at the view's edges, and no caption may cover. */
  get #kept() {
    const now = performance.now();
    if (now - this.#looked > AGAIN) {
      this.#looked = now;
      const { left, top } = this.#frame.getBoundingClientRect();
      const over = $$(EDGES).filter((node) => getComputedStyle(node).position === "absolute");
      const boxes = over.map((node) => node.getBoundingClientRect());
      this.#edges = boxes.map((box) => ({
        left: box.left - left,
        right: box.right - left,
        top: box.top - top,
        bottom: box.bottom - top,
      }));
    }
    return this.#edges;
  }

  /** @param {HTMLElement} node @returns {[number, number]} */
  #size(node) {
    const known = this.#sizes.get(node) ?? [node.offsetWidth, node.offsetHeight];
    this.#sizes.set(node, known);
    return known;
  }

  /** Each figure's name and the line below. @param {Record<string, [string, string]>} words */
  caption(words) {
    for (const node of this.#captions) {
      const [name, line] = words[node.dataset.figure ?? ""] ?? ["", ""];
      if ($("b", node).textContent === name && $("span", node).textContent === line) continue;
      text($("b", node), name);
      text($("span", node), line);
      this.#sizes.delete(node);
    }
  }
}
