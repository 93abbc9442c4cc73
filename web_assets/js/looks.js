// How each figure is shown, and what is drawn besides: buttons, remembered by the browser.

import { $$ } from "./dom.js";

/** @typedef {"shown" | "ghost" | "hidden"} Look */
/** @typedef {"overlay" | "trails" | "eye"} Besides */

/** @type {Record<Look, { next: Look, pressed: string, says: string }>} */
const LOOKS = {
  shown: { next: "ghost", pressed: "true", says: "shown; press for a ghost" },
  ghost: { next: "hidden", pressed: "mixed", says: "a ghost; press to hide" },
  hidden: { next: "shown", pressed: "false", says: "hidden; press to show" },
};

/** What was kept under a name. @param {string} key */
const kept = (key) => (localStorage.getItem(key) ?? "").split(",").filter(Boolean);

export class Looks {
  /** @type {Map<string, Look>} */
  #figures = new Map([
    ...kept("hidden").map((name) => /** @type {[string, Look]} */ ([name, "hidden"])),
    ...kept("ghosts").map((name) => /** @type {[string, Look]} */ ([name, "ghost"])),
  ]);
  #besides = new Set(kept("besides"));

  constructor() {
    for (const button of $$("#figures button")) {
      const name = button.dataset.figure ?? "";
      const draw = () => {
        const { pressed, says } = LOOKS[this.chosen(name)];
        button.setAttribute("aria-pressed", pressed);
        button.title = `${button.dataset.title}: ${says}`;
      };
      button.addEventListener("click", () => {
        this.#figures.set(name, LOOKS[this.chosen(name)].next);
        this.#keep("hidden", "hidden");
        this.#keep("ghosts", "ghost");
        draw();
      });
      draw();
    }
    for (const button of $$("#besides button")) {
      const name = button.dataset.besides ?? "";
      const draw = () => button.setAttribute("aria-pressed", String(this.#besides.has(name)));
      button.addEventListener("click", () => {
        if (!this.#besides.delete(name)) this.#besides.add(name);
        localStorage.setItem("besides", [...this.#besides].join());
        draw();
      });
      draw();
    }
  }

  /** @param {string} key @param {Look} look */
  #keep(key, look) {
    const names = [...this.#figures.keys()].filter((name) => this.chosen(name) === look);
    localStorage.setItem(key, names.join());
  }

  /** What a figure's button says. @param {string} figure */
  chosen(figure) {
    return this.#figures.get(figure) ?? "shown";
  }

  /** How a figure is drawn: none is hidden that is to be compared. @param {string} figure */
  of(figure) {
    const look = this.chosen(figure);
    const needed = figure === "reference" && this.on("overlay");
    return needed && look === "hidden" ? "shown" : look;
  }

  /** Whether there is a ghost. */
  get haunted() {
    return [...this.#figures.values()].includes("ghost");
  }

  /** @param {Besides} what */
  on(what) {
    return this.#besides.has(what);
  }
}
