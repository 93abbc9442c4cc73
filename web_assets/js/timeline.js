// The timeline's canvas: scrubbing and trimming by pointer; timeline-paint.js draws it.

import { FRAME } from "./motion.js";
import { rarely } from "./rarely.js";
import { Scale, paintCurves, paintMarks } from "./timeline-paint.js";

/** @import { Curves, Review, Suggestion } from "../types/page.js" */

const GRIP = 9; // px beside a handle that still hold it
const HANDLE = 36; // px from the top in which a handle is easy to hold
const SHORTEST = 0.1; // s that a trim leaves
const RARELY = 60; // ms between two seeks on the way
/** How far a key moves, s; Home and End reach past either end. @type {Record<string, number>} */
const STEPS = {
  ArrowLeft: -FRAME,
  ArrowRight: FRAME,
  ArrowDown: -FRAME,
  ArrowUp: FRAME,
  PageDown: -1,
  PageUp: 1,
  Home: -Infinity,
  End: Infinity,
};

/**
 * Which handle of a trim a pointer holds, or the time under it.
 *
 * @param {[number, number]} handles px from the left
 * @param {{ x: number, y: number }} pointer px
 * @returns {0 | 1 | "seek"}
 */
export function gripAt(handles, { x, y }) {
  const [start, end] = handles.map((handle) => Math.abs(handle - x));
  const nearest = start < end ? 0 : 1;
  const distance = Math.min(start, end);
  return distance < GRIP && (y < HANDLE || distance < 5) ? nearest : "seek";
}

/**
 * A trim with one end moved to t, but not past the other.
 *
 * @param {[number, number]} trim s
 * @param {0 | 1} end
 * @param {number} t s
 * @returns {[number, number]}
 */
export const trimmed = ([start, stop], end, t) =>
  end === 0 ? [Math.min(t, stop - SHORTEST), stop] : [start, Math.max(t, start + SHORTEST)];

/**
 * What the timeline says of itself.
 *
 * @param {number} t s
 * @param {number} seconds
 * @param {[number, number]} trim s
 */
export function spokenTime(t, seconds, [start, end]) {
  const whole = start <= 0 && end >= seconds;
  const kept = whole ? "" : `; kept from ${start.toFixed(2)} to ${end.toFixed(2)}`;
  return `${t.toFixed(2)} of ${seconds.toFixed(2)} seconds${kept}`;
}

export class Timeline {
  /** @type {Curves | null} */
  #data = null;
  /** @type {[number, number]} */
  #trim = [0, 0];
  /** @type {[number, number][]} */
  #cuts = [];
  /** @type {Suggestion[]} */
  #flaws = [];
  /** @type {0 | 1 | "seek" | null} */
  #held = null;
  #moved = false;
  #t = 0;
  #speed = 0;
  #stamp = 0;
  /** @type {(t: number) => void} */
  #seek;
  #version = 0;
  #painted = { key: "", curves: document.createElement("canvas") };

  /**
   * @param {HTMLCanvasElement} canvas
   * @param {{ seek: (t: number) => void, trim: (range: [number, number]) => void }} on
   */
  constructor(canvas, on) {
    this.canvas = canvas;
    this.on = on;
    this.#seek = rarely(RARELY, on.seek);
    canvas.addEventListener("pointerdown", (event) => this.#down(event));
    canvas.addEventListener("pointermove", (event) => this.#move(event));
    canvas.addEventListener("pointerup", () => this.#up());
    canvas.addEventListener("pointercancel", () => this.#up());
    canvas.addEventListener("keydown", (event) => this.#key(event));
    new ResizeObserver(() => this.draw()).observe(canvas);
    const each = () => {
      if (this.#speed && canvas.offsetParent) this.draw();
      requestAnimationFrame(each);
    };
    requestAnimationFrame(each);
  }

  /** @param {Curves} data @param {Pick<Review, "edits" | "suggestions">} review */
  load(data, { edits, suggestions }) {
    this.#data = data;
    this.#version += 1;
    this.#trim = edits.trim ?? [0, data.seconds];
    this.#cuts = edits.cuts ?? [];
    this.#flaws = suggestions;
    this.#speak();
    this.draw();
  }

  /** Shown now: t (s), and how fast it moves on. @param {number} t @param {number} speed */
  at(t, speed) {
    if (this.#held === "seek" || (t === this.#t && speed === this.#speed)) return;
    this.#t = t;
    this.#speed = speed;
    this.#stamp = performance.now();
    this.#speak();
    this.draw();
  }

  /** For whoever hears the page. */
  #speak() {
    if (!this.#data) return;
    const { seconds } = this.#data;
    this.canvas.setAttribute("aria-valuemax", seconds.toFixed(2));
    this.canvas.setAttribute("aria-valuenow", this.#t.toFixed(2));
    this.canvas.setAttribute("aria-valuetext", spokenTime(this.#t, seconds, this.#trim));
  }

  /** @param {KeyboardEvent} event */
  #key(event) {
    const step = STEPS[event.key];
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    if (step === undefined || !this.#data) return;
    event.preventDefault();
    this.#t = Math.max(0, Math.min(this.#data.seconds, this.#t + step));
    this.#speed = 0;
    this.#seek(this.#t);
    this.#speak();
    this.draw();
  }

  get #scale() {
    return new Scale(this.#data?.seconds ?? 0, this.canvas.clientWidth);
  }

  /** @returns {[number, number]} px */
  #handles() {
    const [start, end] = this.#trim;
    return [this.#scale.x(start), this.#scale.x(end)];
  }

  /** @param {PointerEvent} event */
  #down(event) {
    if (!this.#data) return;
    this.#held = gripAt(this.#handles(), this.#where(event));
    this.canvas.setPointerCapture(event.pointerId);
    this.#move(event);
  }

  /** @param {PointerEvent} event */
  #move(event) {
    if (!this.#data) return;
    const { x } = this.#where(event);
    if (this.#held === null) {
      const near = this.#handles().some((handle) => Math.abs(handle - x) < GRIP);
      this.canvas.style.cursor = near ? "ew-resize" : "pointer";
      return;
    }
    const t = this.#scale.t(x);
    if (this.#held === "seek") {
      this.#t = t;
      this.#speed = 0;
      this.#seek(t);
    } else {
      this.#trim = trimmed(this.#trim, this.#held, t);
      this.#moved = true;
    }
    this.draw();
  }

  #up() {
    const [start, end] = this.#trim.map((t) => Math.round(1000 * t) / 1000);
    if (this.#moved) this.on.trim([start, end]);
    this.#held = null;
    this.#moved = false;
  }

  /** @param {PointerEvent} event */
  #where(event) {
    const box = this.canvas.getBoundingClientRect();
    return { x: event.clientX - box.left, y: event.clientY - box.top };
  }

  /** Curves are painted once; afterwards only what lies over them moves. */
  draw() {
    const { canvas } = this;
    const ratio = devicePixelRatio || 1;
    const width = canvas.clientWidth;
    const height = canvas.clientHeight;
    const pen = canvas.getContext("2d");
    if (!width || !height || !this.#data || !pen) return;
    const scale = this.#scale;
    const style = getComputedStyle(document.documentElement);
    const colour = (/** @type {string} */ name) => style.getPropertyValue(`--${name}`).trim();
    const theme = document.documentElement.dataset.theme;
    const key = [width, height, ratio, theme, this.#version].join();
    const { curves } = this.#painted;
    if (key !== this.#painted.key) {
      this.#painted.key = key;
      canvas.width = curves.width = Math.round(width * ratio);
      canvas.height = curves.height = Math.round(height * ratio);
      const below = curves.getContext("2d");
      below?.setTransform(ratio, 0, 0, ratio, 0, 0);
      if (below) paintCurves({ pen: below, colour, scale, height }, this.#data);
    }
    pen.setTransform(1, 0, 0, 1, 0, 0);
    pen.clearRect(0, 0, canvas.width, canvas.height);
    pen.drawImage(curves, 0, 0);
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    const passed = (this.#speed * (performance.now() - this.#stamp)) / 1000;
    const now = Math.min(this.#data.seconds, this.#t + passed);
    paintMarks(
      { pen, colour, scale, height },
      { trim: this.#trim, cuts: this.#cuts, flaws: this.#flaws, now },
    );
  }
}
