// The dock of live plots below the view: asked beside done, to freeze, read off and take away.

import uPlot from "../vendor/uplot/uPlot.esm.js";

import { $, $button, $select, el, text } from "./dom.js";
import { HISTORY } from "./history.js";
import { FRAME } from "./motion.js";
import { PLOTS, Signals } from "./signals.js";

/** @import { Tick } from "../types/page.js" */

const HEIGHT = 150;
const SECONDS = HISTORY * FRAME;
const COLOURS = ["--reference", "--robot"];

/** @param {string} name of a file @param {Blob} blob */
function save(name, blob) {
  const url = URL.createObjectURL(blob);
  el("a", { href: url, download: name }).click();
  URL.revokeObjectURL(url);
}

export class PlotDock {
  #dock = /** @type {HTMLDetailsElement} */ ($("#plots"));
  #signals = new Signals();
  #frozen = false;
  /** @type {uPlot | null} */
  #plot = null;

  constructor() {
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
    this.#dock.open = localStorage.getItem("plots") === "open";
    this.#dock.addEventListener("toggle", () => {
      localStorage.setItem("plots", this.#dock.open ? "open" : "");
      this.#make();
    });
    $("#plot-freeze").addEventListener("click", () => this.#freeze(!this.#frozen));
    $("#plot-csv").addEventListener("click", () =>
      save("a1-signals.csv", new Blob([this.#signals.csv], { type: "text/csv" })),
    );
    $("#plot-png").addEventListener("click", () => {
      const canvas = /** @type {HTMLCanvasElement | undefined} */ (this.#plot?.ctx.canvas);
      canvas?.toBlob((blob) => blob && save(`a1-${choice.value}.png`, blob));
    });
    new ResizeObserver(() => this.#plot?.setSize(this.#size)).observe($("#plot"));
    this.#make();
  }

  /** Open or close it. */
  toggle = () => {
    this.#dock.open = !this.#dock.open;
  };

  /** @param {Tick} tick */
  add(tick) {
    if (!this.#frozen) this.#signals.add(tick);
  }

  /** Four times a second. */
  draw() {
    const { lag } = this.#signals;
    text($("#plot-lag"), lag === null ? "" : `joints follow ${lag.toFixed(0)} ms behind`);
    if (this.#plot && !this.#frozen) this.#plot.setData(this.#data);
  }

  get #what() {
    return PLOTS[$select("#plot-what").value];
  }

  get #size() {
    return { width: $("#plot").clientWidth, height: HEIGHT };
  }

  /** Seconds before now, and each curve. @returns {uPlot.AlignedData} */
  get #data() {
    const { samples } = this.#signals;
    const now = samples.at(-1)?.t ?? 0;
    const curves = this.#what.curves.map(([name]) => samples.map((sample) => sample[name]));
    return [samples.map(({ t }) => t - now), ...curves];
  }

  /** @param {boolean} frozen */
  #freeze(frozen) {
    this.#frozen = frozen;
    const button = $button("#plot-freeze");
    button.setAttribute("aria-pressed", String(frozen));
    text(button, frozen ? "Go on" : "Freeze");
    if (!frozen) this.#signals.clear();
  }

  #make() {
    this.#plot?.destroy();
    this.#plot = null;
    if (!this.#dock.open) return;
    const { unit, digits, curves } = this.#what;
    const style = getComputedStyle(document.documentElement);
    const colour = (/** @type {string} */ name) => style.getPropertyValue(name).trim();
    const axis = {
      stroke: () => colour("--muted"),
      grid: { stroke: () => colour("--line"), width: 1 },
      ticks: { show: false },
      font: "11px system-ui, sans-serif",
    };
    const shown = (/** @type {uPlot} */ _, /** @type {number | null} */ value) =>
      value == null ? "–" : `${value.toFixed(digits)} ${unit}`;
    this.#plot = new uPlot(
      {
        ...this.#size,
        scales: { x: { time: false, range: [-SECONDS, 0] } },
        axes: [
          { ...axis, size: 24, values: (_, at) => at.map((s) => `${s} s`) },
          { ...axis, size: 52, values: (_, at) => at.map((v) => `${+v.toFixed(3)}`) },
        ],
        series: [
          { label: "Time", value: (_, s) => (s == null ? "–" : `${s.toFixed(1)} s`) },
          ...curves.map(([, label], i) => ({
            label,
            stroke: () => colour(COLOURS[i]),
            width: 1.6,
            value: shown,
          })),
        ],
      },
      this.#data,
      $("#plot"),
    );
  }
}
