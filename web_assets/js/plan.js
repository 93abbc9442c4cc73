// The plan: how often to act out each task, by whom, and how it is shown.

import { $, $button, $input, attempt, el, text, toast } from "./dom.js";
import { capital, spoken } from "./words.js";

/** @import { PlanItem, Task } from "../types/page.js" */
/** @import { Studio } from "./studio.js" */

const STATES = ["stand", "walk", "sit"];
const MOST = 20;
const NOTES = "Notes on this session";

/**
 * What is posted of the numbers chosen, in the order of the tasks.
 *
 * @param {Task[]} tasks
 * @param {Map<string, number>} counts takes of a task
 * @param {number} seconds
 * @returns {PlanItem[]}
 */
export const itemsOf = (tasks, counts, seconds) =>
  tasks.flatMap(({ task }) => {
    const takes = counts.get(task);
    return takes ? { task, takes, seconds } : [];
  });

export class Plan {
  /** @type {Task[]} */
  #tasks = [];
  /** @type {Map<string, number>} */
  #counts = new Map();

  /** @param {Studio} studio @param {() => void} unlock called before a plan begins */
  constructor(studio, unlock) {
    this.studio = studio;
    this.unlock = unlock;
  }

  /** The card's content. */
  fields() {
    const operator = el("input", {
      type: "text",
      id: "collect-operator",
      maxlength: 60,
      value: localStorage.getItem("operator") ?? "me",
      onchange: () => localStorage.setItem("operator", operator.value),
    });
    const number = { type: "number", id: "collect-seconds", min: 2, max: 60, step: 1, value: 8 };
    const choice = (
      /** @type {string} */ id,
      /** @type {string} */ words,
      /** @type {string} */ title,
      /** @type {boolean} */ checked,
    ) =>
      el(
        "label",
        { class: "switch", title },
        el("input", { type: "checkbox", id, role: "switch", checked }),
        el("span", {}, words),
      );
    return [
      el("label", { class: "field" }, el("span", {}, "Who acts"), operator),
      el("div", {
        class: "plan",
        id: "plan",
        role: "group",
        "aria-label": "How often to act out each task",
      }),
      el("label", { class: "field" }, el("span", {}, "Seconds each"), el("input", number)),
      el(
        "div",
        { class: "row switches" },
        choice("collect-preview", "Preview", "Show each motion once before it is recorded", true),
        choice(
          "collect-free",
          "Hands free",
          "Go on without buttons: takes are kept after four seconds",
          false,
        ),
        choice("collect-sound", "Ticks", "Tick to each step of a gait", true),
      ),
      el("input", {
        type: "text",
        id: "collect-notes",
        maxlength: 4000,
        placeholder: `${NOTES} (optional)`,
        "aria-label": NOTES,
      }),
      el(
        "button",
        { class: "wide main", id: "collect-begin", onclick: () => attempt(() => this.#begin()) },
        "Begin",
      ),
    ];
  }

  /** Ask which tasks there are. */
  async load() {
    this.#tasks = await this.studio.api.get("/api/collect/tasks").catch(() => []);
    const groups = STATES.map((state) => {
      const tasks = this.#tasks.filter((task) => task.state === state);
      const rows = tasks.map((task) => this.#row(task));
      return el("fieldset", {}, el("legend", {}, capital(state)), ...rows);
    });
    $("#plan").replaceChildren(...groups);
  }

  /** @param {Task} task */
  #row({ task, prompt }) {
    const count = el("output", {}, "0");
    const change = (/** @type {number} */ by) => {
      const n = Math.min(MOST, Math.max(0, (this.#counts.get(task) ?? 0) + by));
      this.#counts.set(task, n);
      text(count, String(n));
      row.classList.toggle("on", n > 0);
    };
    const button = (/** @type {string} */ words, /** @type {number} */ by) =>
      el(
        "button",
        {
          "aria-label": `${by > 0 ? "More" : "Fewer"} takes of ${task}`,
          onclick: () => change(by),
        },
        words,
      );
    const name = capital(spoken(task.replace(/^sit_/, "")));
    const row = el(
      "div",
      { class: "choice", "data-task": task, title: prompt },
      el("span", {}, name),
      button("−", -1),
      count,
      button("+", 1),
    );
    return row;
  }

  /** How long each motion is, s. */
  get seconds() {
    return +$input("#collect-seconds").value;
  }

  async #begin() {
    this.unlock();
    const { api } = this.studio;
    const items = itemsOf(this.#tasks, this.#counts, this.seconds);
    if (!items.length) {
      toast("Choose at least one task: press + beside it");
      return;
    }
    const begin = $button("#collect-begin");
    begin.disabled = true;
    text(begin, "Drawing motions …");
    try {
      await api.post("/api/collect/plan", {
        items,
        operator: $input("#collect-operator").value.trim() || "me",
        notes: $input("#collect-notes").value.trim(),
        preview: $input("#collect-preview").checked,
        hands_free: $input("#collect-free").checked,
      });
      if (!this.studio.collecting) await api.post("/api/mode", { mode: "collect" });
      $("#collect").removeAttribute("open"); // out of the way of the takes to come
    } finally {
      begin.disabled = false;
      text(begin, "Begin");
    }
  }
}
