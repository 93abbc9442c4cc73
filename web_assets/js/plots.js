// The dock of plots below the view: asked beside done, live or of the take under review.

import { $, $button, $select, el, text } from "./dom.js";
import { HISTORY } from "./history.js";
import { FRAME } from "./motion.js";
import { Plot } from "./plot.js";
import { PLOTS, csv } from "./signals.js";
import { capital } from "./words.js";

/** @import uPlot from "../vendor/uplot/uPlot.esm.js" */
/** @import { Series } from "../types/page.js" */
/** @import { Bench } from "./doors.js" */
/** @import { Api } from "./net.js" */
/** @import { Signals } from "./signals.js" */

const SECONDS = HISTORY * FRAME;
/** Instants of a take that are drawn: more than a screen has columns. */
const POINTS = 2000;

/** @param {string} name of a file @param {Blob} blob */
function save(name, blob) {
  const url = URL.createObjectURL(blob);
  el("a", { href: url, download: name }).click();
  URL.revokeObjectURL(url);
}

export class PlotDock {
  frozen = false;
  #dock = /** @type {HTMLDetailsElement} */ ($("#plots"));
  /** @type {Plot | null} */
  #plot = null;
  /** The take on the bench. @type {Bench | null} */
  #bench = null;
  /** What is known of it. @type {Series | null} */
  #series = null;
  /** On its way. @type {ReturnType<PlotDock["ask"]> | null} */
  #asked = null;
  #t = 0;

  /** @param {Api} api @param {Signals} signals */
  constructor(api, signals) {
    this.api = api;
    this.signals = signals;
    const choice = $select("#plot-what");
    choice.replaceChildren(
      ...Object.entries(PLOTS).map(([value, { title }]) => el("option", { value }, title)),
    );
    choice.value = localStorage.getItem("plot") ?? "speed";
    if (!choice.value) choice.value = "speed";
    choice.addEventListener("change", () => {
      localStorage.setItem("plot", choice.value);
      this.#make();
    });
    $("#plot-freeze").addEventListener("click", () => this.#freeze(!this.frozen));
    $("#plot-csv").addEventListener("click", () =>
      save(`${this.#name}-signals.csv`, new Blob([this.#csv], { type: "text/csv" })),
    );
    $("#plot-png").addEventListener("click", () => {
      const name = `${this.#name}-${choice.value}.png`;
      this.#plot?.canvas.toBlob((blob) => blob && save(name, blob));
    });
    new ResizeObserver(() => this.#plot?.fit()).observe($("#plot"));
  }

  /** What is live, or a take; anew, too, where the dock was opened or closed. */
  async show(/** @type {Bench | null} */ bench) {
    if (bench !== this.#bench) this.#series = this.#asked = null;
    this.#bench = bench;
    this.#t = 0;
    let trouble = "";
    if (bench && this.#dock.open && !this.#series) {
      this.#make();
      const asked = (this.#asked ??= this.ask(bench)); // opened while a take is: asked for once
      const series = await asked.catch((error) => void (trouble = capital(error.message)));
      if (bench !== this.#bench) return; // another one is shown by now
      this.#asked = null;
      this.#series = series ?? null;
      if (series?.problem) trouble = `The take ends early: ${series.problem}`;
    }
    text($("#plot-error"), trouble);
    $("#plot-error").hidden = !trouble;
    this.#make();
  }

  /** Its signals over time. @param {Bench} bench */
  ask = ({ name }) => this.api.get("/api/takes/{name}/series", { name, points: POINTS });

  /** The time at which the take is shown, s. @param {number} t */
  at(t) {
    if (t === this.#t) return;
    this.#t = t;
    if (this.#series) this.#plot?.at(t);
  }

  /** Four times a second. */
  draw() {
    const { lag } = this.signals;
    const late = lag === null ? "" : `joints follow ${lag.toFixed(0)} ms behind`;
    text($("#plot-lag"), this.#bench ? "of the take" : late);
    if (this.#plot && !this.#bench && !this.frozen) this.#plot.data = this.#data;
  }

  get #what() {
    return PLOTS[$select("#plot-what").value];
  }

  get #name() {
    return this.#bench?.name ?? "a1";
  }

  /** One signal of what is shown. @param {string} name */
  #of = (name) => (this.#series ? this.#series.signals[name] : this.signals.of(name));

  get #csv() {
    return csv(this.#series?.t_s ?? this.signals.times, this.#of);
  }

  /** Seconds into the take, or before now, and each curve. @returns {uPlot.AlignedData} */
  get #data() {
    const curves = this.#what.curves.map(([name]) => this.#of(name));
    if (this.#series) return [this.#series.t_s, ...curves];
    const { times } = this.signals;
    return [times.map((t) => t - (times.at(-1) ?? 0)), ...curves];
  }

  /** @param {boolean} frozen */
  #freeze(frozen) {
    this.frozen = frozen;
    const button = $button("#plot-freeze");
    button.setAttribute("aria-pressed", String(frozen));
    text(button, frozen ? "Go on" : "Freeze");
    if (!frozen) this.signals.clear();
  }

  #make() {
    this.#plot?.destroy();
    this.#plot = null;
    $("#plot-freeze").hidden = this.#bench !== null;
    const span = this.#bench ? "take" : "last 20 s";
    $("#plot-csv").title = `All signals of the ${span}`;
    const lacking = this.#bench !== null && !this.#series;
    for (const button of ["#plot-csv", "#plot-png"]) $button(button).disabled = lacking;
    if (!this.#dock.open || lacking) return;
    const { seconds } = this.#series ?? {};
    /** @type {[number, number]} */
    const range = seconds === undefined ? [-SECONDS, 0] : [0, seconds];
    this.#plot = new Plot(this.#what, this.#data, range, this.#bench?.seek ?? null);
    if (this.#series) this.#plot.at(this.#t);
  }
}
