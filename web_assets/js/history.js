// What the last ticks took: their rate, and milliseconds by section.

/** @import { Tick } from "../types/page.js" */

/** Ticks that are remembered: 20 s. */
export const HISTORY = 600;
const WINDOW = 5000; // ms
const SOON = 2000; // ms
/** Sums of other sections, and waiting, are not work. */
const SUMS = new Set([
  "retarget",
  "inference",
  "total",
  "tick",
  "period",
  "wait",
  "sleep",
  "jitter",
]);

export class TickHistory {
  /** ms of work of each tick, the newest last. @type {number[]} */
  total = [];
  /** ms a section took of late. @type {Map<string, number>} */
  sections = new Map();
  /** ms at which the ticks of the last WINDOW came, the oldest first. @type {number[]} */
  #came = [];
  /** ms at which the first came. */
  #first = Infinity;

  /**
   * Ticks a second that reached us, over the last five seconds, or since the first if that is
   * less: after a pause of the page they come at once, and are no faster for it. 0 until there is
   * enough to tell.
   */
  get rate() {
    const ms = Math.min(WINDOW, (this.#came.at(-1) ?? 0) - this.#first);
    return ms < SOON ? 0 : (1000 * this.#came.length) / ms;
  }

  /** @param {Pick<Tick, "timings_ms">} tick @param {number} now ms */
  add({ timings_ms }, now) {
    this.#first = Math.min(this.#first, now);
    this.#came.push(now);
    while (this.#came[0] <= now - WINDOW) this.#came.shift();
    let total = 0;
    for (const [name, ms] of Object.entries(timings_ms)) {
      if (SUMS.has(name)) continue;
      total += ms;
      this.sections.set(name, 0.95 * (this.sections.get(name) ?? ms) + 0.05 * ms);
    }
    this.total.push(total);
    if (this.total.length > HISTORY) this.total.shift();
  }

  /** ms that a share p of the ticks stayed below; 0 before the first. @param {number} p */
  percentile(p) {
    const sorted = this.total.toSorted((a, b) => a - b);
    return sorted[Math.min(sorted.length - 1, Math.floor(p * sorted.length))] ?? 0;
  }
}
