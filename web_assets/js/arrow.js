// An arrow over the 3-D view, with a word at its tip, and what it is drawn from.

import { $, text } from "./dom.js";

/** px: half of its shaft's width, and of its head's; the head's length. */
const SHAFT = 3;
const HEAD = 10;
const LONG = 17;
/** px from its tip to its word; room for that at the view's right. */
const ASIDE = 14;
const ROOM = 110;

/** A point of the screen, px. @typedef {[number, number]} Pixel */

/**
 * The corners of an arrow; one that is too short is all head.
 *
 * @param {Pixel} from @param {Pixel} to @returns {Pixel[]}
 */
export function corners([x, y], [a, b]) {
  const long = Math.hypot(a - x, b - y);
  if (!(long > 1)) return [];
  const [u, v] = [(a - x) / long, (b - y) / long];
  const head = Math.min(LONG, long);
  const size = HEAD * (head / LONG);
  const at = (/** @type {number} */ along, /** @type {number} */ aside) =>
    /** @type {Pixel} */ ([x + along * u - aside * v, y + along * v + aside * u]);
  const neck = long - head;
  const [shaft, ends] = [Math.min(SHAFT, size), at(long, 0)];
  return [
    at(0, shaft), at(neck, shaft), at(neck, size), ends,
    at(neck, -size), at(neck, -shaft), at(0, -shaft),
  ]; // prettier-ignore
}

export class Arrow {
  #svg = made("svg");
  #way = made("line");
  #ring = made("polygon");
  #arrow = made("polygon");
  #word = made("text");

  /** @param {string} kind a class */
  constructor(kind) {
    this.#svg.classList.add("arrow", kind);
    this.#svg.setAttribute("aria-hidden", "true");
    this.#way.classList.add("way");
    this.#ring.classList.add("ring");
    this.#svg.append(this.#way, this.#ring, this.#arrow, this.#word);
  }

  /**
   * From a point to another, and on to the pointer, where that is elsewhere; over a ring.
   *
   * @param {Pixel} from @param {Pixel} to @param {string} word
   * @param {{ on?: Pixel, ring?: number[][] }} [besides]
   */
  draw(from, to, word, { on = to, ring = [] } = {}) {
    const ends = { x1: to[0], y1: to[1], x2: on[0], y2: on[1] };
    for (const [name, value] of Object.entries(ends)) this.#way.setAttribute(name, `${value}`);
    this.#arrow.setAttribute("points", corners(from, to).join(" "));
    this.#ring.setAttribute("points", ring.join(" "));
    const sight = $(".sight");
    // Beyond the tip; where there is no room, on its other side.
    const back = on[0] < from[0] - 1 ? on[0] > ROOM : on[0] > sight.clientWidth - ROOM;
    this.#word.setAttribute("text-anchor", back ? "end" : "start");
    this.#word.setAttribute("x", `${on[0] + (back ? -ASIDE : ASIDE)}`);
    this.#word.setAttribute("y", `${Math.max(18, on[1] - ASIDE / 2)}`);
    text(this.#word, word);
    if (!this.#svg.parentNode) sight.append(this.#svg);
  }

  remove() {
    this.#svg.remove();
  }
}

/** @template {"svg" | "line" | "polygon" | "text"} T @param {T} name */
const made = (name) => document.createElementNS("http://www.w3.org/2000/svg", name);
