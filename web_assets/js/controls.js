// How the robot is driven: state, style of walking, controller, sliders; and the experts' votes.

import { $, $$, $input, $select, attempt, el, press, setStyle, text, toast } from "./dom.js";
import { capital, spoken } from "./words.js";

/** @import { Gain, State, Tick } from "../types/page.js" */
/** @import { Studio } from "./studio.js" */

/**
 * @type {{ name: Gain, title: string, low: number, high: number, step: number,
 *   show: (value: number) => string, help: string }[]}
 */
const SLIDERS = [
  {
    name: "tilt_gain",
    title: "Tilt gain",
    low: 0,
    high: 2,
    step: 0.05,
    show: (v) => `× ${v.toFixed(2)}`,
    help: "How far the robot leans when you do",
  },
  {
    name: "dead_zone",
    title: "Dead zone",
    low: 0,
    high: 0.3,
    step: 0.005,
    show: (v) => `${((v * 180) / Math.PI).toFixed(1)}°`,
    help: "Leaning less than this is ignored",
  },
  {
    name: "speed_cap",
    title: "Speed cap",
    low: 0,
    high: 1.5,
    step: 0.01,
    show: (v) => `${v.toFixed(2)} m/s`,
    help: "The robot walks no faster",
  },
  {
    name: "joint_speed",
    title: "Quickness",
    low: Math.PI / 3,
    high: (8 * Math.PI) / 3,
    step: Math.PI / 18,
    show: (v) => `${((v * 180) / Math.PI).toFixed(0)}°/s`,
    help: "How fast its joints may be where it stands or sits: faster is less late, less steady",
  },
];
/** @type {Record<State["style"], string>} */
const STYLES = {
  march: "marching in place",
  circles: "circling your hands",
  semantic: "marching, read by rule",
};
/**
 * What each does with the reference: what an operator has to know before choosing it.
 *
 * @type {Record<State["controller"], string>}
 */
const CONTROLLERS = {
  policy: "Trained to balance while it tracks.",
  pd_playback:
    "The reference straight to the motors, without balance: " +
    "walking faster than 0.2 m/s it often falls.",
  stand_still: "Holds the neutral pose whatever you do.",
};

export class Controls {
  /** @param {Studio} studio */
  constructor({ api }) {
    const each = (
      /** @type {string} */ group,
      /** @type {(button: HTMLElement) => Promise<unknown>} */ ask,
    ) => {
      for (const button of $$(`${group} button`))
        button.addEventListener("click", () => attempt(() => ask(button)));
    };
    each("#mode", ({ dataset }) => {
      const mode = /** @type {State["mode"]} */ (dataset.mode);
      return api.post("/api/mode", { mode });
    });
    each("#lock", ({ dataset }) => {
      const state = /** @type {State["state_lock"]} */ (dataset.state);
      return api.post("/api/state", { state });
    });
    each("#style", async ({ dataset }) => {
      const style = /** @type {State["style"]} */ (dataset.style);
      await api.post("/api/style", { style });
      toast(`Walking means ${STYLES[style]} now`, "good");
    });
    each("#steps", ({ dataset }) => {
      const steps = /** @type {State["steps"]} */ (dataset.steps);
      return api.post("/api/steps", { steps });
    });
    each("#travel", ({ dataset }) => {
      const travel = /** @type {State["travel"]["mode"]} */ (dataset.travel);
      return api.post("/api/travel", { travel });
    });
    const select = $select("#controller");
    select.addEventListener("change", () => {
      const controller = /** @type {State["controller"]} */ (select.value);
      attempt(() => api.post("/api/controller", { controller }));
    });
    for (const { name, title, low, high, step, show, help } of SLIDERS) {
      const output = el("output", { for: name });
      const range = { type: "range", id: name, min: low, max: high, step, title: help };
      const input = el("input", range);
      input.addEventListener("input", () => text(output, show(+input.value)));
      input.addEventListener("change", () =>
        attempt(() => api.post("/api/gain", { name, value: +input.value })),
      );
      const label = el("span", {}, title);
      $("#sliders").append(el("label", { class: "slider", title: help }, label, output, input));
    }
    for (const name of ["stand", "walk", "sit"])
      $("#votes").append(
        el("div", { class: "vote", "data-name": name }, capital(name), el("i"), el("em")),
      );
  }

  /** Thirty times a second. @param {Tick} tick */
  drawVotes({ votes, expert }) {
    for (const row of $$("#votes .vote")) {
      const name = row.dataset.name ?? "";
      const share = votes[name] ?? 0;
      setStyle($("i", row), { "--v": share });
      text($("em", row), `${Math.round(100 * share)} %`);
      row.classList.toggle("won", expert === name);
    }
  }

  /** @param {State} state */
  draw({ mode, state_lock, style, steps, travel, gains, controller, controllers }) {
    press($("#mode"), "mode", mode);
    press($("#lock"), "state", state_lock);
    press($("#style"), "style", style);
    press($("#steps"), "steps", steps);
    press($("#travel"), "travel", travel.mode);
    for (const { name, show } of SLIDERS) {
      const input = $input(`#${name}`);
      if (document.activeElement === input || gains[name] === undefined) continue;
      input.value = String(gains[name]);
      text($(`output[for="${name}"]`), show(gains[name]));
    }
    const select = $select("#controller");
    if (select.dataset.names !== controllers.join()) {
      select.dataset.names = controllers.join();
      const options = controllers.map((value) => el("option", { value }, capital(spoken(value))));
      select.replaceChildren(...options);
    }
    if (document.activeElement !== select) select.value = controller;
    text($("#controller-note"), CONTROLLERS[controller]);
  }
}
