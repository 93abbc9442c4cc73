// Mode collect: plan what to act out, be counted in, act it out, keep it or do it again.

import { Coach } from "./coach.js";
import { Collected } from "./collected.js";
import { drawMap } from "./datamap.js";
import { $, el, text, toView } from "./dom.js";
import { libraryButton } from "./doors.js";
import { Importer } from "./imports.js";
import { MappersPanel } from "./mappers.js";
import { Plan } from "./plan.js";
import { TrainPanel } from "./train.js";

/** @import { State } from "../types/page.js" */
/** @import { ReviewDoor } from "./doors.js" */
/** @import { Studio } from "./studio.js" */

/** @param {string} id @param {string} title @param {...Node} content */
const card = (id, title, ...content) =>
  el(
    "details",
    { class: "card work", id, open: true },
    el("summary", {}, title, el("span", { class: "hint", id: `${id}-now` })),
    ...content,
  );

export class CollectPanels {
  /** What was drawn last: a change of it is a reason to read takes and map anew. */
  #last = { on: false, phase: "", done: 0 };

  /** @param {Studio} studio @param {ReviewDoor} review */
  constructor(studio, review) {
    this.studio = studio;
    this.review = review;
    this.importer = new Importer(studio, review.open);
    this.coach = new Coach(studio, review.open);
    this.plan = new Plan(studio, () => this.coach.unlock());
    this.collected = new Collected(studio, review.open, (names) => this.train.pick(names));
    const list = this.collected.fields();
    const covered = [
      el("div", { id: "map-next", class: "proposals" }),
      el("div", { id: "map-states", class: "map" }),
    ];
    $("#guide").after(
      card("collect", "Collect", ...this.plan.fields()),
      card("collected-card", "Takes", libraryButton(), this.importer.zone(), ...list),
      card("map", "What is covered", ...covered),
      card("train", "Train a mapper of your own", el("div", { id: "train-body" })),
    );
    this.mappers = new MappersPanel(studio);
    this.train = new TrainPanel(studio, () => this.mappers.refresh());
    document.addEventListener("takes-changed", () => {
      this.collected.refresh();
      this.#map();
    });
    this.plan.load();
    this.collected.refresh();
  }

  /**
   * Go to where takes are trained on, with these ticked.
   *
   * @param {string[]} [names]
   */
  trainOn = async (names) => {
    await this.studio.api.post("/api/mode", { mode: "collect" });
    await this.collected.refresh();
    if (names) this.collected.tickOnly(names);
    // The panels of this mode are there once the state has said so.
    const show = () => {
      if (!$("#train").offsetParent) return this.studio.collecting && requestAnimationFrame(show);
      $("#train").scrollIntoView();
      $("#train summary").focus({ preventScroll: true });
    };
    setTimeout(show, 300);
  };

  #map() {
    if (this.studio.collecting || this.review.on) drawMap(this.studio, () => this.plan.seconds);
  }

  /** Ten times a second, with the state. @param {State} state */
  draw(state) {
    const { collect, mapper } = state;
    const { phase, done, total } = collect;
    const on = this.studio.collecting;
    const last = this.#last;
    this.#last = { on, phase, done };
    if (on && !last.on) $("#panels").scrollTop = 0; // where its own begin
    if (on && phase !== last.phase) toView();
    if (on && (!last.on || phase !== last.phase || done !== last.done)) {
      this.collected.refresh();
      if (phase !== "record" && phase !== "countdown") this.#map();
    }
    this.coach.draw(collect, on, on && !this.review.on);
    if (on) text($("#collect-now"), total ? `${done} of ${total} done` : "");
    this.train.follow(mapper.style);
    this.mappers.draw(state);
  }
}
