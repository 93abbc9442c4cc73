// The library: all takes with pictures and scores, many at once, and what was thrown away.

import { CardKeys } from "./card-keys.js";
import { $, $$, $input, el, takesChanged, text } from "./dom.js";
import { binActions, binned, restored, takeActions } from "./library-actions.js";
import { binCard, takeCard } from "./library-cards.js";
import { length, space } from "./library-list.js";
import { libraryDialog } from "./library-parts.js";
import { Tools } from "./library-tools.js";
import { Pictures, Scorer } from "./pictures.js";
import { Selection } from "./selection.js";

/** @import { Binned, Take } from "../types/page.js" */
/** @import { Studio } from "./studio.js" */

/**
 * Where the library leads to.
 *
 * @typedef {object} Hooks
 * @property {(take: string) => unknown} review
 * @property {(takes: string[]) => unknown} train
 */

const ROWS = 60; // cards at first, and more at each press of a button

export class Library {
  /** @type {Take[]} */
  #takes = [];
  #read = false;
  /** @type {{ bytes: number, takes: Binned[] }} */
  #bin = { bytes: 0, takes: [] };
  #selection = new Selection();
  #rows = ROWS;
  /** How many takes have no score yet. */
  #unscored = 0;

  /** @param {Studio} studio @param {Hooks} hooks */
  constructor(studio, hooks) {
    this.studio = studio;
    this.hooks = hooks;
    this.dialog = libraryDialog(() => this.close());
    const { api } = studio;
    this.tools = new Tools(api, () => this.#list());
    this.pictures = new Pictures(api);
    this.scorer = new Scorer(api, (scores, left) => this.#scored(scores, left));
    this.keys = new CardKeys($("#library-list"), (id) => this.#stretch(id));
    this.inBin = binActions(api, () => this.#chosen);
    this.outside = takeActions(
      api,
      () => this.#chosenTakes,
      (names) => this.#lead(() => this.hooks.train(names)),
    );
    const clear = el("button", { id: "many-clear", onclick: () => this.#clear() }, "Clear");
    $("#library-many").append(clear, ...this.outside, ...this.inBin.nodes);
    $("#library-bin").addEventListener("click", () => this.#turn(!this.#showsBin));
    $("#library-all").addEventListener("click", () => this.#all());
    $("#library-more").addEventListener("click", () => {
      this.#rows += ROWS;
      this.#list();
    });
    this.dialog.addEventListener("keydown", (event) => this.#down(event));
    // Escape, where the robot is known not to move: first the selection, then the library.
    this.dialog.addEventListener("cancel", (event) => {
      if (!this.#selection.size) return;
      event.preventDefault();
      this.#clear();
    });
    document.addEventListener("takes-changed", () => this.dialog.open && this.#refresh());
  }

  /** Not modal: the stop button must stay within reach. */
  async show() {
    if (this.dialog.open) return;
    this.dialog.show();
    this.#turn(false);
    await this.#refresh();
    this.keys.enter();
  }

  close() {
    this.dialog.close();
  }

  get #showsBin() {
    return $("#library-bin").getAttribute("aria-pressed") === "true";
  }

  /** To the bin, or back. @param {boolean} bin */
  #turn(bin) {
    $("#library-bin").setAttribute("aria-pressed", String(bin));
    text($("#library-title"), bin ? "Bin" : "Library");
    for (const node of this.outside) node.hidden = bin;
    this.#rows = ROWS;
    this.#clear();
    this.#list();
  }

  async #refresh() {
    const { api } = this.studio;
    const [takes, bin, sessions] = await Promise.all([
      api.get("/api/takes").catch(() => this.#takes),
      api.get("/api/bin").catch(() => this.#bin),
      api.get("/api/collect/sessions").catch(() => null),
    ]);
    this.#takes = takes;
    this.#read = true;
    this.#bin = bin;
    if (sessions) this.tools.offer(sessions);
    this.#list();
    this.scorer.score(this.#listed, () => this.dialog.open);
  }

  /** @param {Record<string, number>} scores @param {number} left */
  #scored(scores, left) {
    this.#unscored = left;
    for (const take of this.#takes) take.score ??= scores[take.name];
    if (left) this.#list();
    else takesChanged(); // every list of them says it
  }

  get #listed() {
    return this.tools.of(this.#takes);
  }

  /** Of what can be chosen, all, in order. */
  get #ids() {
    if (this.#showsBin) return this.#bin.takes.map(({ place }) => place);
    return this.#listed.filter(({ recording }) => !recording).map(({ name }) => name);
  }

  get #chosen() {
    return this.#selection.of(this.#ids);
  }

  get #chosenTakes() {
    const names = new Set(this.#chosen);
    return this.#takes.filter(({ name }) => names.has(name));
  }

  #list() {
    const bin = this.#showsBin;
    this.tools.show(bin);
    this.#selection.retain(this.#ids);
    const has = (/** @type {string} */ id) => this.#selection.has(id);
    const all = bin
      ? this.#bin.takes.map((one) => () => binCard(one, has(one.place), this.pictures, this.#on))
      : this.#listed.map((take) => () => takeCard(take, has(take.name), this.pictures, this.#on));
    const cards = all.slice(0, this.#rows).map((card) => card());
    if (!cards.length) cards.push(el("li", { class: "empty" }, this.#nothing));
    this.keys.redraw(() => $("#library-list").replaceChildren(...cards));
    $("#library-more").hidden = all.length <= this.#rows;
    this.#say();
  }

  get #nothing() {
    if (!this.#read) return "Reading…";
    if (this.#showsBin) return "The bin is empty.";
    if (!this.#takes.length) return "No takes yet. Recording keeps you and the robot together.";
    return "No take is like that.";
  }

  /** What is listed, and what is chosen of it. */
  #say() {
    const bin = this.#showsBin;
    const count = this.#ids.length;
    const of = bin || count === this.#takes.length ? "" : ` of ${this.#takes.length}`;
    const said = [
      !this.#read ? "" : `${count}${of} ${count === 1 && !of ? "take" : "takes"}`,
      bin ? space(this.#bin.bytes) : "",
      this.#unscored ? `${this.#unscored} still to be scored` : "",
    ];
    text($("#library-says"), said.filter(Boolean).join(" · "));
    const chosen = this.#chosen;
    $("#library-many").hidden = !chosen.length;
    const seconds = this.#chosenTakes.reduce((sum, take) => sum + length(take), 0);
    const bytes = this.#bin.takes.reduce(
      (sum, one) => sum + (chosen.includes(one.place) ? one.bytes : 0),
      0,
    );
    const size = bin ? space(bytes) : `${seconds.toFixed(0)} s`;
    text($("#library-chosen"), `${chosen.length} selected · ${size}`);
    for (const card of $$("li[data-id]", $("#library-list"))) {
      const on = this.#selection.has(card.dataset.id ?? "");
      card.classList.toggle("chosen", on);
      $input("input", card).checked = on;
    }
  }

  #on = {
    choose: (/** @type {string} */ id, /** @type {MouseEvent} */ event) => {
      if (event.shiftKey) return this.#stretch(id);
      this.#selection.set(id, $input(`[data-id="${id}"] input`, this.dialog).checked);
      this.#chose();
    },
    review: (/** @type {string} */ name) => this.#lead(() => this.hooks.review(name)),
    replay: (/** @type {string} */ name) =>
      this.#lead(async () => {
        await this.#drive(name);
        await this.studio.api.post("/api/mode", { mode: "replay" });
      }),
    drive: (/** @type {string} */ name) => this.#lead(() => this.#drive(name)),
    restore: (/** @type {string} */ place) => restored(this.studio.api, [place]),
  };

  /** @param {string} name */
  #drive(name) {
    return this.studio.api.post("/api/source", { source: `take:${name}` });
  }

  /** Elsewhere on the page. @param {() => unknown} where */
  async #lead(where) {
    await where();
    this.close();
  }

  /** @param {KeyboardEvent} event */
  #down(event) {
    const focus = /** @type {HTMLElement} */ (event.target);
    const typing = focus instanceof HTMLInputElement && focus.type === "text";
    if (event.key === "a" && (event.ctrlKey || event.metaKey) && !typing) {
      event.preventDefault();
      this.#all();
    } else if (event.key === "Delete" && focus.closest("#library-list") && !this.#showsBin) {
      const names = this.#chosen;
      if (names.length) binned(this.studio.api, names);
    }
  }

  /** @param {string} id */
  #stretch(id) {
    this.#selection.stretch(this.#ids, id);
    this.#chose();
  }

  #all() {
    this.#selection.all(this.#ids);
    this.#chose();
  }

  #clear() {
    this.#selection.clear();
    this.#chose();
  }

  /** What was asked of another selection is not asked of this one. */
  #chose() {
    this.inBin.show(this.#showsBin);
    this.#say();
  }
}
