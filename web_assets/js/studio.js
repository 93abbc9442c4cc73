// What every panel shares: the API, the newest tick and state, and what the page is busy with.

import { Api } from "./net.js";
import { Stillness } from "./stillness.js";

/** @import { State, Tick } from "../types/page.js" */

const LATE = 1000; // ms without a tick until the link is doubted
const SILENT = 3000; // and until what is shown is stale

export class Studio {
  api = new Api();
  /** @type {Tick | null} */
  tick = null;
  /** @type {State | null} */
  state = null;
  /** locked: the studio is there, and does not know this page. */
  /** @type {"connecting" | "up" | "down" | "locked"} */
  link = "connecting";
  /** ms on the page's clock when the newest tick came; 0 before the first. */
  lastTick = 0;
  stillness = new Stillness();

  /** ms without a tick; 0 before the first. */
  get silence() {
    return this.lastTick ? performance.now() - this.lastTick : 0;
  }

  /** Whether ticks do not come as they should. */
  get late() {
    return this.silence > LATE;
  }

  /** Whether what is shown is no longer true. */
  get silent() {
    return this.silence > SILENT;
  }

  /** Whether the robot is known not to move. */
  get still() {
    return this.stillness.still(this.state, performance.now());
  }

  /** Whether the robot shows what to act out. */
  get collecting() {
    return this.state?.mode === "collect";
  }
}
