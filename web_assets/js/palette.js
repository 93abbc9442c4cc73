// Everything the page can do, found by a few letters of what it is called.

import { $, $input, attempt, el, text } from "./dom.js";
import { pageEntries } from "./entries.js";

/** @typedef {{ words: string, key?: string, run: () => unknown }} Entry */

const ROWS = 12;

/**
 * The entries in which each typed word occurs; those that begin with what was typed come first.
 *
 * @template {{ words: string }} T
 * @param {T[]} entries
 * @param {string} typed
 * @returns {T[]}
 */
export function matching(entries, typed) {
  const asked = typed.toLowerCase().split(/\s+/).filter(Boolean);
  const found = entries.filter(({ words }) =>
    asked.every((word) => words.toLowerCase().includes(word)),
  );
  const begins = (/** @type {T} */ { words }) => words.toLowerCase().startsWith(asked.join(" "));
  return asked.length ? found.toSorted((a, b) => Number(begins(b)) - Number(begins(a))) : found;
}

export class Palette {
  #dialog = /** @type {HTMLDialogElement} */ ($("#palette"));
  #typed = $input("#palette-typed");
  #list = $("#palette-list");
  /** @type {Entry[]} */
  #found = [];
  #at = 0;

  /** @param {() => Entry[]} entries what can be done just now, besides what the page lists */
  constructor(entries) {
    this.entries = entries;
    this.#typed.addEventListener("input", () => this.find());
    this.#typed.addEventListener("keydown", (event) => {
      const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
      if (step) this.#mark((this.#at + step + this.#found.length) % this.#found.length);
      else if (event.key === "Enter") this.choose();
      else return;
      event.preventDefault();
    });
    this.#dialog.addEventListener("focusout", ({ relatedTarget }) => {
      if (!this.#dialog.contains(/** @type {Node | null} */ (relatedTarget))) this.#dialog.close();
    });
  }

  /** Do what is marked. */
  choose() {
    this.#run(this.#found[this.#at]);
  }

  /** Those that what is typed calls. */
  find() {
    const all = [...pageEntries(), ...this.entries()];
    this.#found = matching(all, this.#typed.value).slice(0, ROWS);
    const rows = this.#found.map((entry, i) =>
      el(
        "li",
        {
          id: `palette-${i}`,
          role: "option",
          onmousedown: (/** @type {Event} */ event) => event.preventDefault(),
          onclick: () => this.#run(entry),
        },
        entry.words,
        entry.key ? el("kbd", {}, entry.key) : null,
      ),
    );
    this.#list.replaceChildren(...rows);
    text($("#palette-none"), rows.length ? "" : "Nothing is called that.");
    this.#mark(0);
  }

  /** @param {number} at */
  #mark(at) {
    this.#at = at;
    [...this.#list.children].forEach((row, i) =>
      row.setAttribute("aria-selected", String(i === at)),
    );
    this.#typed.setAttribute("aria-activedescendant", this.#found.length ? `palette-${at}` : "");
    this.#list.children[at]?.scrollIntoView({ block: "nearest" });
  }

  /** @param {Entry | undefined} entry */
  #run(entry) {
    if (!entry) return;
    this.#dialog.close();
    attempt(async () => entry.run());
  }
}
