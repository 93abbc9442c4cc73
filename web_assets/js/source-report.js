// What was read of the source, under the drop zone; the joint map is loaded when it is wanted.

import { $, attempt, el, text } from "./dom.js";
import { capital, jointName, reportLine } from "./words.js";

/** @import { State } from "../types/page.js" */
/** @import { Joints } from "./joints.js" */
/** @import { Studio } from "./studio.js" */

export class SourceReport {
  #shown = "";
  /** @type {Joints | null} */
  #joints = null;

  /** @param {Studio} studio */
  constructor(studio) {
    this.studio = studio;
    $("#joints-edit").addEventListener("click", () => attempt(() => this.map()));
  }

  /** The joint map of the source in use, or of one that could not be read without.
   *
   * @param {string} [source]
   */
  async map(source) {
    const { Joints } = await import("./joints.js");
    this.#joints ??= new Joints(this.studio);
    await this.#joints.show(source);
  }

  /** @param {State} state */
  draw({ source, source_report, arrivals }) {
    const { joints_missing, notes, refused } = source_report;
    const file = /^(bvh|frames):/.test(source);
    $("#load").hidden = !file && refused.frames === 0 && !arrivals;
    text($("#load summary"), reportLine(source_report, arrivals));
    const shown = JSON.stringify([source, source_report]);
    if (shown === this.#shown) return;
    this.#shown = shown;
    const lines = [
      joints_missing.length ? `Missing: ${joints_missing.map(jointName).join(", ")}.` : "",
      ...notes.map((note) => `${capital(note)}.`),
      ...refused.why.map((why) => `Refused: ${why}.`),
    ].filter(Boolean);
    $("#load ul").replaceChildren(...lines.map((line) => el("li", {}, line)));
    $("#joints-edit").hidden = !source.startsWith("bvh:");
  }
}
