// The mappers trained here: which drives, another in its place, A/B and back.

import { $, $button, attempt, el, text, toast } from "./dom.js";
import { RivalsPart } from "./rivals.js";
import { capital, counted } from "./words.js";

/** @import { State } from "../types/page.js" */
/** @import { Studio } from "./studio.js" */

/** Of a file of one's own its class: FILE.py:Class. @param {string} name */
const short = (name) => name.split(":").at(-1) ?? name;

export class MappersPanel {
  /** What is drawn: names of the mapper in use and of the one before. */
  #drawn = "";
  /** How many there were of one's own. */
  #own = 0;

  /** @param {Studio} studio */
  constructor(studio) {
    this.studio = studio;
    this.rivals = new RivalsPart(studio);
    // Which mapper drives matters most while driving: its card is there in every mode.
    const card = el(
      "details",
      { class: "card also", id: "mapper", hidden: true },
      el("summary", {}, "Mapper", el("span", { class: "hint", id: "mapper-now" })),
      el("div", { class: "ab", id: "ab" }),
      el("ul", { class: "takes", id: "mappers" }),
      this.rivals.body,
    );
    $("#lock").closest(".card")?.after(card);
    this.refresh();
    this.rivals.refresh();
  }

  /** Read the list anew. */
  async refresh() {
    const found = await this.studio.api.get("/api/mappers").catch(() => null);
    if (!found) return;
    this.#drawn = "";
    const card = /** @type {HTMLDetailsElement} */ ($("#mapper"));
    if (found.length > this.#own || card.hidden) card.open = found.length > 0;
    this.#own = found.length;
    card.hidden = false;
    $("#mappers").replaceChildren(
      ...found.reverse().map(({ name, made, states, takes, style }) => {
        const about = `${states.join(", ")} · ${counted(takes.length, "take")} · ${style}`;
        return this.#row(name, name, about, made);
      }),
      this.#row("shipped", "Shipped", "trained on many synthetic people"),
    );
  }

  /** @param {string} name @param {string} title @param {string} about @param {string} [made] */
  #row(name, title, about, made) {
    const use = async () => {
      await this.studio.api.post("/api/mapper", { name });
      toast(`${capital(short(name))} drives the robot now`, "good");
    };
    return el(
      "li",
      { "data-mapper": name },
      el("div", { class: "name", title: made }, el("b", {}, title), el("span", {}, about)),
      el("button", { onclick: () => attempt(use) }, "Use"),
    );
  }

  /** @param {State} state */
  draw({ mapper }) {
    this.rivals.draw(mapper);
    const { name, before } = mapper;
    const now = `${name}/${before}`;
    if (this.#drawn === now) return;
    this.#drawn = now;
    text($("#mapper-now"), short(name));
    // One of a file, named when the studio was begun, is in no list.
    if (name.includes(":") && !$("#mappers").querySelector(`[data-mapper="${CSS.escape(name)}"]`))
      $("#mappers").prepend(this.#row(name, short(name), "your own file"));
    for (const row of $("#mappers").children) {
      const used = /** @type {HTMLElement} */ (row).dataset.mapper === name;
      row.classList.toggle("now", used);
      const button = $button("button", row);
      button.disabled = used;
      text(button, used ? "In use" : "Use");
    }
    const swap = {
      id: "ab-swap",
      title: "Use the one before; press again to return",
      onclick: () => attempt(() => this.studio.api.post("/api/mapper/back")),
    };
    const ab = [
      el("span", {}, "A/B"),
      el("button", swap, el("b", {}, short(name)), ` ⇄ ${short(before ?? "")}`),
    ];
    $("#ab").replaceChildren(...(before ? ab : []));
  }
}
