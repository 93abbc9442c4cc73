// Pictures and scores of takes, asked for a few at a time: those first that are on the screen.

import { attempt } from "./dom.js";

/** @import { Take } from "../types/page.js" */
/** @import { Api } from "./net.js" */

const AT_ONCE = 12; // pictures
const AGAIN_MS = 5000; // until a picture that was not to be had is asked for again
const SCORED = 4; // takes: each is looked over whole

/** @typedef {Pick<Take, "name" | "started" | "undoable" | "redoable">} Pictured */

/** Which take, as its edits leave it. @param {Pictured} take */
const version = ({ name, started, undoable, redoable }) =>
  [name, started, undoable, redoable].join("|");

/** Which recording: another may have its name later. @param {Take} take */
const recording = ({ name, started }) => `${name} ${started}`;

/**
 * A picture a take, drawn by the studio from its tape; remembered until the take is edited. That
 * there was none is not: a take may have been in the bin just then, or the studio too busy.
 */
export class Pictures {
  /** Data URLs by a take's version. @type {Map<string, string>} */
  #known = new Map();
  /** Images that wait for theirs. @type {Map<HTMLImageElement, Pictured>} */
  #wanted = new Map();
  #asking = false;
  #seen = new IntersectionObserver((entries) => {
    for (const { target, isIntersecting } of entries) {
      const image = /** @type {HTMLImageElement} */ (target);
      const take = this.#takes.get(image);
      if (!take) continue;
      if (isIntersecting) this.#wanted.set(image, take);
      else this.#wanted.delete(image);
    }
    this.#ask();
  });
  /** @type {WeakMap<HTMLImageElement, Pictured>} */
  #takes = new WeakMap();

  /** @param {Api} api */
  constructor(api) {
    this.api = api;
  }

  /** Give an image its take's picture, now or once it is on the screen. */
  /** @param {HTMLImageElement} image @param {Pictured} take its name may be a place in the bin */
  show(image, take) {
    const known = this.#known.get(version(take));
    if (known) image.src = known;
    else {
      this.#takes.set(image, take);
      this.#seen.observe(image);
    }
  }

  async #ask() {
    if (this.#asking) return;
    this.#asking = true;
    while (this.#wanted.size) {
      const some = [...this.#wanted].slice(0, AT_ONCE);
      for (const [image] of some) {
        this.#wanted.delete(image);
        this.#seen.unobserve(image);
      }
      const names = [...new Set(some.map(([, { name }]) => name))];
      const found = await this.api.post("/api/takes/thumbnails", { names }).catch(() => null);
      for (const [image, take] of some) {
        const svg = found?.pictures[take.name];
        if (!svg) {
          setTimeout(() => image.isConnected && this.#seen.observe(image), AGAIN_MS);
          continue;
        }
        image.src = `data:image/svg+xml,${encodeURIComponent(svg)}`;
        this.#known.set(version(take), image.src);
      }
    }
    this.#asking = false;
  }
}

/** Looks over takes that have no score yet, for as long as somebody looks at them. */
export class Scorer {
  /** @type {Set<string>} */
  #tried = new Set();
  #busy = false;

  /**
   * @param {Api} api
   * @param {(scores: Record<string, number>, left: number) => void} scored told after each few
   */
  constructor(api, scored) {
    this.api = api;
    this.scored = scored;
  }

  /** @param {Take[]} takes the first come first @param {() => boolean} goOn */
  async score(takes, goOn) {
    if (this.#busy) return;
    this.#busy = true;
    const lacking = takes.filter(
      (take) =>
        take.score == null &&
        !take.damaged &&
        !take.recording &&
        take.ticks &&
        !this.#tried.has(recording(take)),
    );
    while (lacking.length && goOn()) {
      const some = lacking.splice(0, SCORED);
      for (const take of some) this.#tried.add(recording(take));
      const names = some.map(({ name }) => name);
      const found = await attempt(() => this.api.post("/api/takes/scores", { names }));
      if (!found) break;
      this.scored(found.scores, lacking.length);
    }
    this.#busy = false;
  }
}
