// What is loaded only when it is wanted, so that the page is there sooner.

import { $, attempt, el } from "./dom.js";

/** @import { State, Tick } from "../types/page.js" */
/** @import { CollectPanels } from "./collect.js" */
/** @import { Found } from "./files.js" */
/** @import { Hooks, Library } from "./library.js" */
/** @import { PlotDock } from "./plots.js" */
/** @import { Review } from "./review.js" */
/** @import { Signals } from "./signals.js" */
/** @import { Studio } from "./studio.js" */

const KEYS = ["P", ",", ".", "I", "O", "Z", "Y", "L"];
const COACH_KEYS = ["G", "V", "K", "B", "N", "M"];
const SOON = 1500; // ms after the figures are drawn, when nothing else is waited for
const AT_LAST = 10000; // ms after the page's start, if they never are
const AGAIN = 3000; // ms until another try

/** The review's bench, from the first take that is opened on. */
export class ReviewDoor {
  /** @type {Review | null} */
  #review = null;

  /**
   * @param {Studio} studio
   * @param {(take: string, t: number) => unknown} film from t s on
   * @param {PlotsDoor} plots
   */
  constructor(studio, film, plots) {
    this.studio = studio;
    this.film = film;
    this.plots = plots;
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
      this.#review ??= new Review(this.studio, this.film, this.plots);
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

/** Collecting, imports, training: from soon after the start on, or at once where it is wanted. */
export class CollectDoor {
  /** @type {CollectPanels | null} */
  #panels = null;
  /** @type {Promise<CollectPanels> | null} */
  #loading = null;
  /** ms at which it is loaded unasked. */
  #due = performance.now() + AT_LAST;

  /** @param {Studio} studio @param {ReviewDoor} review */
  constructor(studio, review) {
    this.studio = studio;
    this.review = review;
  }

  /** What mattered more is there. */
  soon() {
    this.#due = Math.min(this.#due, performance.now() + SOON);
  }

  /** @returns {Promise<CollectPanels>} */
  #load() {
    this.#loading ??= import("./collect.js").then(
      ({ CollectPanels }) => (this.#panels = new CollectPanels(this.studio, this.review)),
      (error) => {
        this.#loading = null;
        throw error;
      },
    );
    return this.#loading;
  }

  /** What keys do while collecting. */
  get keys() {
    return Object.fromEntries(
      COACH_KEYS.map((key) => [key, () => this.#panels?.coach.keys[key]()]),
    );
  }

  /** Keep the take on the bench, and go to where it is trained on. */
  keepAndTrain = async () => {
    if (this.review.on) await this.review.keep();
    await this.trainOn();
  };

  /** Go to where takes are trained on, with these ticked. @param {string[]} [names] */
  trainOn = async (names) => (await this.#load()).trainOn(names);

  /** Files that become takes. @param {Found[]} files */
  take = (files) => attempt(async () => (await this.#load()).importer.take(files));

  /** Ten times a second, with the state. @param {State} state */
  draw(state) {
    const on = this.studio.collecting;
    document.body.dataset.work = on || this.review.on ? "collect" : "";
    const now = performance.now();
    if (this.#panels) this.#panels.draw(state);
    else if (!this.#loading && (on || now > this.#due)) {
      this.#due = now + AGAIN; // where nothing answers, the page says so elsewhere
      this.#load().catch(() => {});
    }
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

/**
 * A take under review, and what goes to a time of it, s.
 *
 * @typedef {{ name: string, seek: (t: number) => unknown }} Bench
 */

/** The dock of plots, from when it is first open on; signals are kept for it from soon after the
 * start. */
export class PlotsDoor {
  #dock = /** @type {HTMLDetailsElement} */ ($("#plots"));
  /** @type {Promise<Signals> | null} */
  #loading = null;
  /** @type {Signals | null} */
  #signals = null;
  /** @type {PlotDock | null} */
  #plots = null;
  /** @type {Bench | null} */
  #bench = null;

  /** @param {Studio} studio */
  constructor(studio) {
    this.studio = studio;
    this.#dock.addEventListener("toggle", () => {
      localStorage.setItem("plots", this.#dock.open ? "open" : "");
      document.body.toggleAttribute("data-plots", this.#dock.open);
      attempt(this.#load);
    });
    this.#dock.open = localStorage.getItem("plots") === "open";
  }

  /** @returns {Promise<Signals>} */
  #listen() {
    this.#loading ??= import("./signals.js").then(
      ({ Signals }) => (this.#signals = new Signals()),
      (error) => {
        this.#loading = null;
        throw error;
      },
    );
    return this.#loading;
  }

  /** What mattered more is there. */
  soon() {
    setTimeout(() => this.#listen().catch(() => {}), SOON);
  }

  #load = async () => {
    if (!this.#dock.open && !this.#plots) return;
    const [{ PlotDock }, signals] = await Promise.all([import("./plots.js"), this.#listen()]);
    this.#plots ??= new PlotDock(this.studio.api, signals);
    await this.#plots.show(this.#bench);
  };

  /** Open or close it. */
  toggle = () => {
    this.#dock.open = !this.#dock.open;
  };

  /** The take on the bench instead of what is live; null for this again. */
  show(/** @type {Bench | null} */ bench) {
    this.#bench = bench;
    attempt(this.#load);
  }

  /** The time at which that take is shown, s. @param {number} t */
  at(t) {
    this.#plots?.at(t);
  }

  /** @param {Tick} tick */
  add(tick) {
    if (!this.#plots?.frozen) this.#signals?.add(tick);
  }

  /** Four times a second. */
  draw() {
    this.#plots?.draw();
  }
}

/** A button that opens the library. */
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
