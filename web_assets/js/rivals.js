// Mappers to compare one's own with: which there are, what each is, and one in its place.

import { $, $button, $select, attempt, el, text, toast } from "./dom.js";
import { capital, rivalLine, rivalName, spoken } from "./words.js";

/** @import { Rival, State } from "../types/page.js" */
/** @import { Studio } from "./studio.js" */

export class RivalsPart {
  /** @type {Rival[]} */
  #rivals = [];
  /** @type {State["mapper"] | null} */
  #mapper = null;

  /** @param {Studio} studio */
  constructor(studio) {
    this.studio = studio;
    const described = { id: "rival", "aria-describedby": "rival-note" };
    this.body = el(
      "div",
      { class: "rivals" },
      el(
        "label",
        { class: "field stacked" },
        el("span", {}, "Rivals (to compare)"),
        el("select", { ...described, onchange: () => this.#show() }),
      ),
      el("p", { class: "note", id: "rival-note" }),
      el("button", { id: "rival-use", onclick: () => attempt(() => this.#use()) }, "Use"),
    );
  }

  /** Read the list anew. */
  async refresh() {
    const found = await this.studio.api.get("/api/rivals").catch(() => null);
    if (!found) return;
    this.#rivals = found;
    const group = (/** @type {string} */ label, /** @type {Rival[]} */ rivals) =>
      el(
        "optgroup",
        { label },
        ...rivals.map((rival) => el("option", { value: rival.name }, rivalName(rival))),
      );
    const select = $select("#rival");
    const { value } = select;
    select.replaceChildren(
      group(
        "Of the paper's comparison",
        found.filter(({ letter }) => letter),
      ),
      group(
        "Others",
        found.filter(({ letter }) => !letter),
      ),
    );
    if (value) select.value = value;
    this.#show();
  }

  async #use() {
    const name = $select("#rival").value;
    const { mapper } = await this.studio.api.post("/api/mapper", { name });
    if (mapper.name === name) toast(`${capital(spoken(name))} drives the robot now`, "good");
  }

  /** @param {State["mapper"]} mapper */
  draw(mapper) {
    const before = this.#mapper;
    this.#mapper = mapper;
    if (before?.name !== mapper.name && this.#rivals.some(({ name }) => name === mapper.name))
      $select("#rival").value = mapper.name;
    this.#show();
  }

  #show() {
    const rival = this.#rivals.find(({ name }) => name === $select("#rival").value);
    if (!rival) return;
    const { name, fitting, refused } = this.#mapper ?? { name: "", fitting: null, refused: {} };
    const used = name === rival.name;
    text($("#rival-note"), rivalLine(rival, used ? Object.keys(refused) : []));
    $("#rival-note").title = used ? Object.values(refused).join("\n") : "";
    const button = $button("#rival-use");
    button.disabled = used || fitting === rival.name;
    text(
      button,
      used ? "In use" : fitting === rival.name ? "Is fitted: some ten seconds…" : "Use",
    );
  }
}
