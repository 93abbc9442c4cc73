// What the last ticks took: their rate, and milliseconds by section.

/** @import { Tick } from "../types/page.js" */

/** Ticks that are remembered: 20 s. */
export const HISTORY = 600;
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
  /** Ticks a second that reached us, over the last whole second. */
  rate = 0;
  #count = 0;

  /** @param {number} now ms */
  constructor(now) {
    this.since = now;
  }

  /** @param {Pick<Tick, "timings_ms">} tick @param {number} now ms */
  add({ timings_ms }, now) {
    this.#count += 1;
    if (now - this.since >= 1000) {
      this.rate = (1000 * this.#count) / (now - this.since);
      this.#count = 0;
      this.since = now;
    }
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
