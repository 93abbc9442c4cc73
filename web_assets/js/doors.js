// What is loaded only when it is wanted, so that the page is there sooner: review and library.

import { attempt, el } from "./dom.js";

/** @import { State } from "../types/page.js" */
/** @import { Hooks, Library } from "./library.js" */
/** @import { Review } from "./review.js" */
/** @import { Studio } from "./studio.js" */

const KEYS = ["P", ",", ".", "I", "O", "Z", "Y", "L"];

/** The review's bench, from the first take that is opened on. */
export class ReviewDoor {
  /** @type {Review | null} */
  #review = null;

  /**
   * @param {Studio} studio
   * @param {(take: string, t: number) => unknown} film from t s on
   */
  constructor(studio, film) {
    this.studio = studio;
    this.film = film;
  }

  /** Whether a take is on the bench. */
  get on() {
    return this.#review?.on ?? false;
  }

  /** What keys do; nothing without a take. */
  get keys() {
    return Object.fromEntries(KEYS.map((key) => [key, () => this.#review?.keys[key]()]));
  }

  /** Put a take on the bench and show it. @param {string} name */
  open = (name) =>
    attempt(async () => {
      const { Review } = await import("./review.js");
      this.#review ??= new Review(this.studio, this.film);
      await this.#review.open(name);
    });

  /** Keep the take on the bench, and leave it. */
  async keep() {
    await this.#review?.keep();
  }

  /** Ten times a second, with the state. @param {State} state */
  draw(state) {
    this.#review?.draw(state);
  }
}

/** The library, from when it is first opened on. */
export class LibraryDoor {
  /** @type {Library | null} */
  #library = null;

  /** @param {Studio} studio @param {Hooks} hooks */
  constructor(studio, hooks) {
    this.studio = studio;
    this.hooks = hooks;
    document.addEventListener("open-library", this.open);
  }

  open = () =>
    attempt(async () => {
      const { Library } = await import("./library.js");
      this.#library ??= new Library(this.studio, this.hooks);
      await this.#library.show();
    });
}

/** A button that opens it. */
export const libraryButton = () =>
  el(
    "button",
    {
      class: "wide",
      title: "All takes with pictures and scores; many at once, the bin, exports (U)",
      onclick: () => document.dispatchEvent(new CustomEvent("open-library")),
    },
    "Library",
    el("kbd", {}, "U"),
  );
