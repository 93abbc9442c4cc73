// Where on viser's canvas each figure is seen: all of it, or half in the split view.

import { attempt } from "./dom.js";

/** @import { Draw, Painter } from "./painter.js" */
/** @import { Viser } from "../types/page.js" */

/**
 * px of the canvas, from its left and its top.
 *
 * @typedef {{ x: number, y: number, width: number, height: number }} Rect
 */

/**
 * The person's half and the robots': side by side, or on upright screens one over the other.
 *
 * @param {number} width @param {number} height
 * @param {number} [covered] px at the left, where nothing is to be seen: of the person's
 * @returns {[Rect, Rect]}
 */
export function halves(width, height, covered = 0) {
  if (width >= height) {
    const half = Math.round(covered + (width - covered) / 2);
    return [
      { x: 0, y: 0, width: half, height },
      { x: half, y: 0, width: width - half, height },
    ];
  }
  const half = Math.round(height / 2);
  return [
    { x: 0, y: 0, width, height: half },
    { x: 0, y: half, width, height: height - half },
  ];
}

export class Panes {
  /** Whether person and robots have a picture each. */
  split = false;
  /** px at the left of a split view that something else covers. */
  covered = 0;
  /** More pictures, drawn over the others. @type {Set<(draw: Draw) => void>} */
  more = new Set();
  /** What draws more than one picture, once that was wanted. @type {Painter | null} */
  #painter = null;
  #asked = false;

  /** Every frame. @param {Viser} viser */
  draw(viser) {
    if ((this.split || this.more.size) && !this.#asked) {
      this.#asked = true;
      attempt(async () => {
        const { Painter } = await import("./painter.js");
        this.#painter = new Painter(this);
      });
    }
    this.#painter?.attach(viser);
  }

  /**
   * The camera that a figure is seen by, and where.
   *
   * @param {Viser} viser @param {string} figure
   */
  of({ camera, canvas }, figure) {
    const { clientWidth: width, clientHeight: height } = canvas;
    const whole = { x: 0, y: 0, width, height };
    if (!this.split || !this.#painter) return { camera, at: whole };
    const [left, right] = halves(width, height, this.covered);
    const person = figure === "human" && this.#painter.person;
    return person ? { camera: person, at: left } : { camera, at: right };
  }
}
