// From seeing a person to driving the robot: the source is set, the person stands quiet until the
// ring is full, then the robot is armed. Whatever stops the robot ends it.

import { Quiet } from "./webcam-framing.js";
import { HumanLink, humanFrame } from "./webcam-link.js";
import { doing, stopped } from "./status.js";
import { capital } from "./words.js";

/** @import { State } from "../types/page.js" */
/** @import { Api } from "./net.js" */
/**
 * What sees the person. source: as the studio calls it. quiet: how long they have kept quiet.
 * frame: what the studio is sent of what was seen. still: what to do until the ring is full.
 *
 * @typedef {{ source: string, frame: (seen: any) => object | null, still: string,
 *   quiet: { reset: () => void, push: (seen: any, framed: boolean) => number } }} Sensor
 */

/** @returns {Sensor} */
const webcam = (quiet = new Quiet()) => ({
  source: "webcam",
  frame: humanFrame,
  still: "Stand upright and quiet until the ring is full",
  quiet: {
    reset: () => quiet.reset(),
    push: ({ world, t }, framed) => quiet.push(world, t, framed),
  },
});
const EVERY = 300; // ms between looks at the studio's state

export class Driving {
  /** off: the studio is told nothing. quiet: the ring fills. on: the robot follows. */
  /** @type {"off" | "quiet" | "on"} */
  stage = "off";
  /** How far the ring is filled. */
  filled = 0;
  /** @type {State | null} */
  state = null;
  /** Frames that the studio refused, and why the last one was. */
  refused = { frames: 0, why: "" };
  #link;

  /**
   * @param {Api} api @param {(line: string) => void} say what the person has to know
   * @param {Sensor} sensor
   */
  constructor(api, say, sensor = webcam()) {
    this.api = api;
    this.say = say;
    this.sensor = sensor;
    const hooks = {
      refused: (/** @type {string} */ why) =>
        (this.refused = { frames: this.refused.frames + 1, why }),
      lost: () => this.#end("The studio does not answer: is it still running?"),
    };
    this.#link = new HumanLink(hooks, sensor.frame);
    setInterval(() => this.#look(), EVERY);
  }

  /** Begin: the robot rests until the ring is full. Throws what the studio refuses. */
  async begin() {
    this.#took(await this.api.get("/api/state"));
    if (this.state?.needs_reset) this.#took(await this.api.post("/api/reset"));
    const { source, quiet } = this.sensor;
    if (this.state?.source !== source) this.#took(await this.api.post("/api/source", { source }));
    this.refused = { frames: 0, why: "" };
    quiet.reset();
    this.#link.open();
    this.filled = 0;
    this.stage = "quiet";
  }

  /** The person has had enough: the robot rests. */
  async end() {
    if (this.stage === "off") return;
    this.#end("");
    this.#took(await this.api.post("/api/mode", { mode: "idle" }));
  }

  async stop() {
    this.#end("");
    this.#took(await this.api.post("/api/stop"));
  }

  /** @param {{ t: number }} seen @param {boolean} framed whether nothing of them is missing */
  push(seen, framed) {
    if (this.stage === "off") return;
    this.#link.send(seen);
    if (this.stage !== "quiet" || this.filled === 1) return;
    this.filled = this.sensor.quiet.push(seen, framed);
    if (this.filled === 1) this.#arm();
  }

  /** What the robot does, or why it does nothing. */
  get line() {
    if (this.stage === "quiet") return this.sensor.still;
    if (!this.state || this.stage === "off") return "";
    return doing(this.state);
  }

  /** What the studio adds to a picture's age while it is driven, or "". */
  get onward() {
    const { arrivals, latency_ms } = this.state ?? {};
    if (this.stage === "off" || !arrivals) return "";
    const ms = (arrivals.wait_ms.p50 ?? 0) + (latency_ms?.inference ?? 0);
    return `, ${ms.toFixed(0)} ms more to the robot’s reference`;
  }

  async #arm() {
    try {
      await this.api.post("/api/calibrate");
      this.#took(await this.api.post("/api/arm"));
      if (this.stage === "quiet") this.stage = "on";
    } catch (error) {
      this.#end(capital(/** @type {Error} */ (error).message));
    }
  }

  async #look() {
    if (this.stage === "off") return;
    try {
      this.#took(await this.api.get("/api/state"));
    } catch (error) {
      return this.#end(capital(/** @type {Error} */ (error).message));
    }
    const { state } = this;
    if (this.stage !== "on" || !state) return;
    if (state.stopped) this.#end(`${stopped(state).title}: press Drive to stand up and go on`);
    else if (state.source !== this.sensor.source) this.#end("Another source drives now");
  }

  /** @param {State} state */
  #took(state) {
    this.state = state;
    this.api.stops = state.stops;
  }

  /** @param {string} line */
  #end(line) {
    this.stage = "off";
    this.#link.close();
    this.say(line);
  }
}
