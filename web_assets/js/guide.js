// A guided first minute over the panels: each step is done by doing it; it can be skipped, and
// found again.

import { $, $$, attempt, el, text } from "./dom.js";

/** @import { State } from "../types/page.js" */

/** What the page does for whoever presses a step's button. */
/** @typedef {"drive" | "sample" | "record" | "review" | "train"} Step */
/** @typedef {Record<Step | "live", () => unknown>} Helps */

/**
 * `done`: whether the step is, given the state and the one before.
 *
 * @type {{ id: Step, words: string, button: string,
 *   done: (state: State, before: State) => boolean }[]}
 */
export const STEPS = [
  {
    id: "drive",
    words: "Drive it: hold W. The person marches, and the robot makes of it what it can.",
    button: "Use the keyboard",
    done: ({ source, state }) => source === "operator:interactive" && state === "walk",
  },
  {
    id: "sample",
    words: "Let a recording drive it.",
    button: "Try a sample",
    done: ({ source }) => source.startsWith("bvh:"),
  },
  {
    id: "record",
    words: "Record a few seconds of both; press again to end.",
    button: "Record",
    done: ({ recording }, before) => recording === null && before.recording !== null,
  },
  {
    id: "review",
    words: "Look at it: scrub, trim, judge.",
    button: "Review the take",
    done: ({ mode }) => mode === "replay",
  },
  {
    id: "train",
    words: "Keep it, and train a mapper of your own on it.",
    button: "Keep it, go to Train",
    done: ({ mode }, before) => mode === "collect" && before.mode !== "collect",
  },
];
const OFF = -1;
/** The person drives the robot, and is recorded beside it, in mode live alone. */
const LIVE = ["drive", "sample", "record"];
const AWAY = {
  words: "First back to Live: there the robot follows the person.",
  button: "Go to Live",
};

export class Guide {
  #step = OFF;
  /** @type {State | null} */
  #before = null;

  /** @param {Helps} helps */
  constructor(helps) {
    $(".panels").prepend($("#guide"));
    $("#guide").append(
      el("p", { role: "status" }),
      el(
        "div",
        { class: "row" },
        el("button", {
          class: "main",
          onclick: () => attempt(() => helps[this.#away ? "live" : STEPS[this.#step].id]()),
        }),
        el("button", { class: "skip-guide", onclick: () => this.#go(OFF) }, "Skip"),
        el("div", { class: "dots", "aria-hidden": "true" }, ...STEPS.map(() => el("i"))),
      ),
    );
    this.#go(Number(localStorage.getItem("guide") ?? 0));
  }

  /** From the first step on. */
  begin = () => this.#go(0);

  /** @param {number} step */
  #go(step) {
    const now = STEPS[step];
    this.#step = now ? step : OFF;
    localStorage.setItem("guide", String(this.#step));
    $("#guide").hidden = !now;
    if (!now) return;
    this.#say();
    $$("#guide i").forEach((dot, i) => dot.classList.toggle("on", i <= step));
  }

  /** Whether the step cannot be done in the mode that is on. */
  get #away() {
    const { mode = "live" } = this.#before ?? {};
    return mode !== "live" && LIVE.includes(STEPS[this.#step].id);
  }

  #say() {
    const { words, button } = this.#away ? AWAY : STEPS[this.#step];
    text($("#guide p"), words);
    text($("#guide .main"), button);
  }

  /** Ten times a second. @param {State} state */
  draw(state) {
    const before = this.#before ?? state;
    this.#before = state;
    if (this.#step === OFF) return;
    this.#say();
    if (STEPS[this.#step].done(state, before)) this.#go(this.#step + 1);
  }
}
