// Recording, and the list of takes.

import { throwAway } from "./bin.js";
import { $, $input, attempt, el, icon, text, toast } from "./dom.js";
import { libraryButton } from "./doors.js";
import { FRAME } from "./motion.js";
import { capital, search } from "./words.js";

/** @import { State, Take } from "../types/page.js" */
/** @import { Studio } from "./studio.js" */

const ROWS = 60;

export class TakesPanel {
  /** @type {Take[]} */
  #takes = [];
  /** Name of the take being recorded; undefined before anything is known. */
  /** @type {string | null | undefined} */
  #recording;
  /** @type {string | null} */
  #trouble = null;

  /** @param {Studio} studio @param {(take: string) => void} openReview */
  constructor(studio, openReview) {
    this.studio = studio;
    this.openReview = openReview;
    $("#record").addEventListener("click", () => attempt(() => this.#record()));
    $("#takes-find").before(libraryButton());
    $("#takes-find").addEventListener("input", () => this.#list());
    document.addEventListener("takes-changed", () => this.#refresh());
    this.#refresh();
  }

  /** Open the newest take for review. */
  reviewLast = () => {
    const last = this.#takes.at(-1);
    if (!last) throw new Error("there is no take yet: press Record");
    return this.openReview(last.name);
  };

  async #record() {
    const { api } = this.studio;
    if (this.#recording) {
      const take = await api.post("/api/takes/stop");
      toast(`Take ${take.name}: ${take.ticks} ticks`, "good");
    } else {
      await api.post("/api/takes/start", { label: $input("#label").value.trim() });
    }
    this.#refresh();
  }

  async #refresh() {
    const takes = await this.studio.api.get("/api/takes").catch(() => null);
    if (!takes) return;
    this.#takes = takes;
    this.#list();
  }

  #list() {
    const { rows, line } = search(this.#takes, $input("#takes-find").value, ROWS);
    const none = !this.#takes.length;
    $("#takes-find").hidden = none;
    text($("#takes-shown"), line);
    $("#takes-shown").hidden = !line;
    const empty = "No takes yet. Recording keeps you and the robot together.";
    $("#takes").replaceChildren(
      ...(none ? [el("li", { class: "empty" }, empty)] : rows.map((take) => this.#row(take))),
    );
  }

  /** @param {Take} take */
  #row({ name, label, seconds, ticks }) {
    const { api } = this.studio;
    const button = (
      /** @type {string | Node} */ words,
      /** @type {string} */ title,
      /** @type {() => unknown} */ what,
      /** @type {object} */ more = {},
    ) => el("button", { title, onclick: () => attempt(what), ...more }, words);
    const drive = () => api.post("/api/source", { source: `take:${name}` });
    // As it was: both figures and the person, from the tape.
    const replay = async () => {
      await drive();
      await api.post("/api/mode", { mode: "replay" });
    };
    const bin = () => throwAway(api, name);
    const being = this.#recording === name;
    const long = `${seconds.toFixed(1)} s · ${ticks} ticks`;
    const words = el(
      "div",
      { class: "name", title: name },
      el("b", {}, label || name),
      el("span", {}, being ? "being recorded" : long),
    );
    if (being) return el("li", {}, words);
    return el(
      "li",
      {},
      words,
      button("Drive", "Let the recorded person drive the robot again", drive),
      button("Review", "Scrub, trim, align, judge", () => this.openReview(name)),
      button("Replay", "Show the take again as it was", replay),
      button(icon("bin"), "Delete (to a bin)", bin, { "aria-label": `Delete ${name}` }),
    );
  }

  /** @param {State} state */
  draw({ recording, recording_error }) {
    const before = this.#recording;
    this.#recording = recording?.name ?? null;
    if (before === undefined && recording)
      toast(`Recording goes on: ${recording.name}`, "good", "");
    if (before !== this.#recording) this.#refresh();
    const button = $("#record");
    button.setAttribute("aria-pressed", String(this.#recording !== null));
    text($("b", button), recording ? "Stop" : "Record");
    $("#chip-rec").hidden = !recording;
    if (recording) text($("#chip-rec b"), `${(recording.ticks * FRAME).toFixed(0)} s`);
    text($("#record-now"), recording?.name ?? "");
    const error = recording_error ? capital(recording_error) : "";
    if (error && recording_error !== this.#trouble) toast(error);
    this.#trouble = recording_error;
    text($("#record-error"), error);
    $("#record-error").hidden = !error;
  }
}
