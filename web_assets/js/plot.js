// One plot by uPlot: curves over seconds, values with their units, a line at the time shown.

import uPlot from "../vendor/uplot/uPlot.esm.js";

import { $, el, setStyle } from "./dom.js";
import { rarely } from "./rarely.js";

/** @import { PLOTS } from "./signals.js" */

const HEIGHT = 150;
const RARELY = 60; // ms between two seeks on the way
const COLOURS = ["--reference", "--robot"];

export class Plot {
  #now = el("div", { class: "plot-now", hidden: true });
  /** @type {uPlot} */
  #plot;
  #host = $("#plot");
  /** The time shown elsewhere, s. @type {number | null} */
  #t = null;

  /**
   * @param {(typeof PLOTS)[string]} what
   * @param {uPlot.AlignedData} data seconds, and each curve
   * @param {[number, number]} range s that are shown
   * @param {((t: number) => unknown) | null} seek to a time that is pressed, if it can be sought
   */
  constructor({ unit, digits, curves }, data, range, seek) {
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
        // uPlot's own cursor, where it points at nothing, clears the values.
        hooks: { draw: [this.#place], setCursor: [this.#place], ready: [this.#place] },
        cursor: { drag: { x: false, y: false } },
        scales: { x: { time: false, range } },
        axes: [
          { ...axis, size: 24, values: (_, at) => at.map((s) => `${s} s`) },
          { ...axis, size: 52, values: (_, at) => at.map((v) => `${+v.toFixed(3)}`) },
        ],
        series: [
          { label: "Time", value: (_, s) => (s == null ? "–" : `${s.toFixed(2)} s`) },
          ...curves.map(([, label], i) => ({
            label,
            stroke: () => colour(COLOURS[i]),
            width: 1.6,
            value: shown,
          })),
        ],
      },
      data,
      this.#host,
    );
    this.#plot.over.append(this.#now);
    if (seek) this.#listen(range, rarely(RARELY, seek));
  }

  /** @param {[number, number]} range @param {(t: number) => unknown} seek */
  #listen([first, last], seek) {
    const { over } = this.#plot;
    const go = (/** @type {PointerEvent} */ event) => {
      const t = this.#plot.posToVal(event.clientX - over.getBoundingClientRect().left, "x");
      seek(Math.max(first, Math.min(last, t)));
    };
    over.addEventListener("pointerdown", (event) => {
      over.setPointerCapture(event.pointerId);
      go(event);
    });
    over.addEventListener("pointermove", (event) => event.buttons && go(event));
  }

  /** @param {uPlot.AlignedData} data */
  set data(data) {
    this.#plot.setData(data);
  }

  /** @returns {HTMLCanvasElement} */
  get canvas() {
    return /** @type {HTMLCanvasElement} */ (this.#plot.ctx.canvas);
  }

  get #size() {
    return { width: this.#host.clientWidth, height: HEIGHT };
  }

  /** The time shown elsewhere: a line there, and its values where nothing is pointed at. */
  at(/** @type {number} */ t) {
    this.#t = t;
    this.#place(this.#plot);
  }

  /** Again with every drawing: until the first, and when the width changes, places do. */
  #place = (/** @type {uPlot} */ plot) => {
    if (this.#t === null) return;
    this.#now.hidden = false;
    setStyle(this.#now, { left: `${plot.valToPos(this.#t, "x")}px` });
    if ((plot.cursor.left ?? -1) < 0) plot.setLegend({ idx: plot.valToIdx(this.#t) });
  };

  fit() {
    this.#plot.setSize(this.#size);
  }

  destroy() {
    this.#plot.destroy();
  }
}
