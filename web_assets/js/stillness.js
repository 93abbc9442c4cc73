// Whether the robot is still: then Escape may close what is open, and is no stop.

/** @import { State, Tick } from "../types/page.js" */

const OVER = 500; // ms
const JOINT = 0.02; // rad that are movement within them
const PLACE = 0.005; // m
const FRESH = 300; // ms: older ticks say nothing of now

export class Stillness {
  /** @type {{ at: number, values: number[] }[]} */
  #seen = [];

  /** @param {Pick<Tick, "robot">} tick @param {number} at ms on the page's clock */
  add({ robot }, at) {
    this.#seen.push({ at, values: [...robot.joint_pos, ...robot.base_pos] });
    while (at - this.#seen[0].at > OVER) this.#seen.shift();
  }

  /**
   * What is not known to be still is not.
   *
   * @param {Pick<State, "stopped"> | null} state
   * @param {number} now ms on the page's clock
   */
  still(state, now) {
    const last = this.#seen.at(-1);
    if (!last || now - last.at > FRESH) return false;
    if (state?.stopped) return true;
    if (last.at - this.#seen[0].at < 0.8 * OVER) return false;
    return last.values.every((_, i) => {
      const values = this.#seen.map((moment) => moment.values[i]);
      return Math.max(...values) - Math.min(...values) < (i < 12 ? JOINT : PLACE);
    });
  }
}
