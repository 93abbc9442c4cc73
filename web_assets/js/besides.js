// What is drawn besides the figures, each loaded when it is first wanted.

import { attempt } from "./dom.js";

/** @import { Eye } from "./eye.js" */
/** @import { Looks } from "./looks.js" */
/** @import { Panes } from "./panes.js" */
/** @import { Trails } from "./trails.js" */
/** @import { State, Tick, Viser } from "../types/page.js" */

export class Besides {
  /** @type {Trails | null} */
  #trails = null;
  /** @type {Eye | null} */
  #eye = null;
  /** @type {(viser: Viser, looks: Looks) => void} */
  #haunt = () => {};
  /** @type {Set<string>} */
  #asked = new Set();

  /**
   * @param {Looks} looks @param {Panes} panes
   * @param {{ newest: () => Tick | null, shows: (figure: string) => boolean }} view
   */
  constructor(looks, panes, { newest, shows }) {
    this.looks = looks;
    this.panes = panes;
    this.newest = newest;
    this.shows = shows;
  }

  /** Once. @param {string} what @param {() => Promise<void>} load */
  #load(what, load) {
    if (this.#asked.has(what)) return;
    this.#asked.add(what);
    attempt(load);
  }

  /** Thirty times a second. @param {Tick} tick @param {State | null} state */
  add(tick, state) {
    if (this.looks.on("trails")) this.#trails?.add(tick, state);
  }

  /** Every frame. @param {Viser} viser */
  draw(viser) {
    if (this.looks.haunted)
      this.#load("ghosts", async () => {
        this.#haunt = (await import("./ghosts.js")).hauntAll;
      });
    this.#haunt(viser, this.looks);
    if (this.looks.on("trails")) {
      this.#load("trails", async () => {
        const { Trails } = await import("./trails.js");
        this.#trails = new Trails();
      });
      this.#trails?.draw(viser);
    } else this.#trails?.remove(viser);
    if (this.looks.on("eye")) {
      this.#load("eye", async () => {
        const { Eye } = await import("./eye.js");
        this.#eye = new Eye(this.panes, this.newest, () => this.shows("robot"));
      });
      this.#eye?.draw(viser);
    } else this.#eye?.remove();
  }
}
