// The takes collected so far: found by words, ticked to be learnt from, opened for review.

import { $, $input, el, text } from "./dom.js";
import { counted, search, spoken } from "./words.js";

/** @import { Take } from "../types/page.js" */
/** @import { Studio } from "./studio.js" */

const ROWS = 80;
const SESSIONS = 3;
const FIND = "Find a take";

/** What a take's row says beside its name. @param {Take} take */
export function about({ trim, seconds, lag, recovered, damaged }) {
  const [start, end] = trim ?? [0, seconds];
  const said = [
    `${(end - start).toFixed(1)} s`,
    lag ? `lag ${lag.toFixed(2)} s` : "",
    damaged ? `damaged: ${damaged}` : recovered ? "recovered" : "",
  ];
  return said.filter(Boolean).join(" · ");
}

/** Which takes to learn from: those that are kept, unless somebody said otherwise since. */
export class Ticks {
  /**
   * What was said of a take, and its verdict then.
   *
   * @type {Map<string, { kept: unknown, on: boolean }>}
   */
  #said = new Map();

  /** @param {Pick<Take, "name" | "kept">} take @param {boolean} on */
  set({ name, kept }, on) {
    this.#said.set(name, { kept, on });
  }

  /** @param {Pick<Take, "name" | "kept">} take */
  has({ name, kept }) {
    const said = this.#said.get(name);
    return said && said.kept === kept ? said.on : kept === true;
  }
}

export class Collected {
  /** From the oldest to the newest. @type {Take[]} */
  #takes = [];
  #ticks = new Ticks();

  /**
   * @param {Studio} studio
   * @param {(take: string) => void} openReview
   * @param {(names: string[]) => void} picked told which takes are ticked, the newest first
   */
  constructor(studio, openReview, picked) {
    this.studio = studio;
    this.openReview = openReview;
    this.picked = picked;
  }

  /** The card's content. */
  fields() {
    return [
      el("input", {
        type: "text",
        id: "collected-find",
        placeholder: `${FIND} by name, label or note`,
        "aria-label": FIND,
        oninput: () => this.#list(),
      }),
      el("p", { class: "note", id: "collected-shown", role: "status" }),
      el("ul", { class: "takes tall", id: "collected" }),
      el("p", { class: "note", id: "collect-sessions" }),
    ];
  }

  /** Read takes and sessions anew. */
  async refresh() {
    const { api } = this.studio;
    const takes = await api.get("/api/takes").catch(() => null);
    if (!takes) return;
    this.#takes = takes;
    this.#list();
    const kept = takes.filter((take) => take.kept).length;
    text($("#collected-card-now"), takes.length ? `${kept} kept of ${takes.length}` : "");
    this.#pick();
    const sessions = await api.get("/api/collect/sessions").catch(() => []);
    const lines = sessions.slice(0, SESSIONS).map(({ operator, day, takes, notes }) => {
      const note = notes ? ` — ${notes}` : "";
      return `${operator}, ${day}: ${counted(takes.length, "take")}${note}`;
    });
    text($("#collect-sessions"), lines.join(" · "));
  }

  /** Tick these and no others. @param {string[]} names */
  tickOnly(names) {
    for (const take of this.#takes) this.#ticks.set(take, names.includes(take.name));
    this.#list();
    this.#pick();
  }

  /** Whether or not a row of the list shows them. */
  #pick() {
    const ticked = this.#takes.filter((take) => this.#ticks.has(take));
    this.picked(ticked.map(({ name }) => name).reverse());
  }

  #list() {
    const { rows, line } = search(this.#takes, $input("#collected-find").value, ROWS);
    $("#collected-find").hidden = !this.#takes.length;
    text($("#collected-shown"), line);
    $("#collected-shown").hidden = !line;
    const empty = el("li", { class: "empty" }, "Nothing yet. What you act out appears here.");
    $("#collected").replaceChildren(
      ...(this.#takes.length ? rows.map((take) => this.#row(take)) : [empty]),
    );
  }

  /** @param {Take} take */
  #row(take) {
    const { name, label, kept, score } = take;
    const verdict = kept === true ? "kept" : kept === false ? "rejected" : "new";
    const percent = Math.round(100 * (score ?? 0));
    const tick = el("input", {
      type: "checkbox",
      "aria-label": `Train on ${name}`,
      title: "Train on it",
      checked: this.#ticks.has(take),
      onchange: () => {
        this.#ticks.set(take, tick.checked);
        this.#pick();
      },
    });
    return el(
      "li",
      { class: verdict, "data-name": name },
      tick,
      el(
        "div",
        { class: "name", title: name },
        el("b", {}, spoken(label || name)),
        el("span", {}, about(take)),
      ),
      score == null
        ? el("em", {}, verdict === "rejected" ? "redone" : "")
        : el(
            "em",
            { class: "score", style: { "--s": percent }, title: "Quality" },
            String(percent),
          ),
      el(
        "button",
        { title: "Scrub, trim, align, judge", onclick: () => this.openReview(name) },
        "Review",
      ),
    );
  }
}
