// The coach over the view: what to act out, the count-down, each step's tick, and what then.

import { $, $$, $button, $input, attempt, el, setStyle, text } from "./dom.js";
import { coached, passed } from "./coached.js";
import { Metronome } from "./metronome.js";
import { Unmeant } from "./unmeant.js";
import { capital } from "./words.js";

/** @import { Action, Collect } from "../types/page.js" */
/** @import { Studio } from "./studio.js" */

/** @typedef {Collect["phase"]} Phase */

/** @type {Record<Phase, string>} */
const PHASES = {
  setup: "Make a plan to begin",
  ready: "Ready when you are",
  preview: "Watch first",
  countdown: "Stand by",
  record: "Act it out",
  review: "How was it?",
  done: "All done",
};

/** @type {{ action: Action, key: string, title: string, phases: Phase[], main?: boolean }[]} */
const BUTTONS = [
  { action: "go", key: "G", title: "Start", phases: ["ready"], main: true },
  { action: "skip", key: "V", title: "I have seen it", phases: ["preview"], main: true },
  { action: "keep", key: "K", title: "Keep", phases: ["review"], main: true },
  { action: "redo", key: "B", title: "Redo", phases: ["review"] },
  { action: "next", key: "N", title: "Next", phases: ["ready", "review"] },
  { action: "abort", key: "M", title: "Abort", phases: ["preview", "countdown", "record"] },
];

export class Coach {
  #metronome = new Metronome((foot) =>
    $(`#coach .feet [data-foot="${foot}"]`).animate(
      [
        { transform: "scale(1.35)", background: "var(--human)", color: "#fff" },
        { transform: "scale(1)" },
      ],
      260,
    ),
  );
  /** The take whose score is shown. @type {string | null} */
  #judged = null;
  /** The last whole second of a count-down that was sounded. */
  #second = 0;
  #unmeant = new Unmeant();

  /** @param {Studio} studio @param {(take: string) => void} openReview */
  constructor(studio, openReview) {
    this.studio = studio;
    const look = () => {
      const take = studio.state?.collect.take;
      if (take) openReview(take);
    };
    const button = (/** @type {(typeof BUTTONS)[number]} */ { action, key, title, main }) =>
      el(
        "button",
        {
          class: main ? "main" : "",
          "data-action": action,
          onclick: () => this.#act(action),
        },
        title,
        el("kbd", {}, key),
      );
    $(".sight").append(
      el("div", { class: "count", id: "count", hidden: true, "aria-hidden": "true" }),
    );
    $(".stage").append(
      el(
        "div",
        { class: "coach", id: "coach", hidden: true, role: "status", "aria-live": "polite" },
        el(
          "div",
          { class: "coach-top" },
          el("span", { class: "phase" }),
          el("b", { class: "task" }),
          el("span", { class: "of" }),
        ),
        el("p", { class: "prompt" }),
        el("div", { class: "meter" }, el("i")),
        el(
          "div",
          { class: "feet", "aria-hidden": "true" },
          el("i", { "data-foot": "0" }, "L"),
          el("i", { "data-foot": "1" }, "R"),
        ),
        el("p", { class: "quality", hidden: true }, el("b"), el("span")),
        el("p", { class: "why" }),
      ),
      el(
        "div",
        { class: "coach-actions", id: "coach-actions", hidden: true },
        ...BUTTONS.map(button),
        el("button", { id: "coach-review", onclick: look }, "Look at it"),
        el(
          "button",
          {
            id: "coach-stand-in",
            class: "main",
            title: "Who acted has nothing more to show",
            onclick: () => attempt(() => this.#standIn()),
          },
          "Let the synthetic person act",
        ),
      ),
    );
    const early = (/** @type {MouseEvent} */ event) => {
      const pointed = event.detail > 0; // Enter and Space are meant for what has the focus
      if (pointed && this.#unmeant.is(performance.now())) event.stopPropagation();
    };
    $("#coach-actions").addEventListener("click", early, true);
  }

  /** @param {Action} action */
  #act(action) {
    return attempt(() => this.studio.api.post("/api/collect/action", { action }));
  }

  /** The synthetic person acts from now on; the plan stays as it is. */
  async #standIn() {
    const { api } = this.studio;
    await api.post("/api/mode", { mode: "live" });
    await api.post("/api/source", { source: "operator" });
    await api.post("/api/mode", { mode: "collect" });
  }

  /** Browsers let a page sound only after somebody has touched it. */
  unlock() {
    this.#metronome.unlock();
  }

  /** Keys mean these only while collecting; the page's own keys stay what they are. */
  get keys() {
    return Object.fromEntries(
      BUTTONS.map(({ action, key, phases }) => [
        key,
        () => {
          const { collecting, state } = this.studio;
          if (collecting && state && phases.includes(state.collect.phase)) this.#act(action);
        },
      ]),
    );
  }

  /** @param {Collect} collect @param {boolean} on collecting @param {boolean} shown */
  draw(collect, on, shown) {
    const { phase, remaining, take, why } = collect;
    $("#coach").hidden = $("#coach-actions").hidden = !shown;
    $("#count").hidden = !(on && phase === "countdown");
    if (!on) {
      this.#metronome.stop();
      return;
    }
    const coach = $("#coach");
    const words = coached(collect);
    coach.dataset.phase = phase;
    text($(".phase", coach), PHASES[phase]);
    text($(".task", coach), words.task);
    text($(".of", coach), words.of);
    text($(".prompt", coach), words.prompt);
    const share = passed(collect);
    setStyle($(".meter", coach), { visibility: share === null ? "hidden" : "visible" });
    setStyle($(".meter i", coach), { transform: `scaleX(${(share ?? 0).toFixed(4)})` });
    text($(".why", coach), capital(why));
    $(".why", coach).hidden = !why;
    const nobody = this.studio.state?.reason === "source_ended";
    $("#coach-stand-in").hidden = !nobody;
    for (const { action, phases } of BUTTONS) {
      const button = $button(`#coach-actions [data-action="${action}"]`);
      button.disabled = !phases.includes(phase) || (nobody && action === "go");
      // "I have seen it" stays where it is until the take ends: Abort beside it must not move away
      // from under a finger.
      const over = action === "skip" && !button.hidden && ["countdown", "record"].includes(phase);
      button.hidden = !phases.includes(phase) && !over;
    }
    $("#coach-review").hidden = !(phase === "review" && take);
    const actions = $("#coach-actions");
    const there = shown ? $$("button:not([hidden])", actions).map((node) => node.textContent) : [];
    actions.classList.toggle("unmeant", this.#unmeant.draw(there.join(), performance.now()));
    this.#judge(phase === "review" ? take : null);
    this.#sound(collect);
    if (phase === "countdown") this.#count(Math.ceil((remaining ?? 0) - 1e-6));
  }

  /** Say how good a take is, once it is known. @param {string | null} take */
  async #judge(take) {
    if (take === this.#judged) return;
    this.#judged = take;
    const line = $("#coach .quality");
    line.hidden = true;
    if (take === null) return;
    const { api } = this.studio;
    const found = await api.get("/api/takes/{name}/review", { name: take }).catch(() => null);
    if (!found || take !== this.#judged) return;
    const { score, reasons } = found.quality;
    text($("b", line), `Score ${Math.round(score)} of 100`);
    text($("span", line), reasons.map(({ message }) => message).join(" · "));
    line.hidden = false;
  }

  get #sounds() {
    return $input("#collect-sound").checked;
  }

  /** @param {Collect} collect */
  #sound({ phase, beats, t }) {
    const beating = Boolean(beats?.length) && ["preview", "record"].includes(phase);
    $("#coach .feet").hidden = !beating;
    if (beats && beating) this.#metronome.follow(beats, t, this.#sounds);
    else this.#metronome.stop();
  }

  /** @param {number} second */
  #count(second) {
    text($("#count"), String(Math.max(1, second)));
    if (second === this.#second) return;
    this.#second = second;
    if (this.#sounds) this.#metronome.click(440, 0.05);
  }
}
