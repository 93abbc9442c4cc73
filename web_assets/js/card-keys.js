// A list of cards by the keyboard: one stop of the Tab key, arrows from card to card.

import { $$ } from "./dom.js";

const STEPS = ["ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown", "Home", "End"];
const WITHIN = "input, button";

export class CardKeys {
  /**
   * @param {HTMLElement} list whose items each hold a checkbox
   * @param {(id: string) => void} stretched Shift and an arrow: the cards up to this one
   */
  constructor(list, stretched) {
    this.list = list;
    this.stretched = stretched;
    list.addEventListener("focusin", (event) => {
      const card = /** @type {HTMLElement} */ (event.target).closest("li");
      if (card) this.#current(card);
    });
    list.addEventListener("keydown", (event) => this.#down(event));
  }

  /** After the list was drawn anew: the focus stays where it was. @param {() => void} draw */
  redraw(draw) {
    const before = this.#cards;
    const at = before.findIndex((card) => card.contains(document.activeElement));
    const id = before[at]?.dataset.id ?? "";
    draw();
    const now = this.#cards;
    const same = now.find((card) => card.dataset.id === id);
    this.#current(same ?? now[0]);
    if (at >= 0) this.#focus(same ?? now[Math.min(at, now.length - 1)]);
  }

  /** To the first card, if there is one. */
  enter() {
    this.#focus(this.#cards[0]);
  }

  get #cards() {
    return $$("li[data-id]", this.list);
  }

  /** @param {Element | undefined} card */
  #focus(card) {
    /** @type {HTMLElement | null | undefined} */ (card?.querySelector("input"))?.focus();
  }

  /** The Tab key stops at this card's parts only. @param {Element | undefined} card */
  #current(card) {
    for (const part of $$(WITHIN, this.list)) part.tabIndex = card?.contains(part) ? 0 : -1;
  }

  /** @param {KeyboardEvent} event */
  #down(event) {
    const cards = this.#cards;
    const at = cards.findIndex((card) => card.contains(/** @type {Node} */ (event.target)));
    if (at < 0 || !STEPS.includes(event.key)) return;
    event.preventDefault();
    const columns = Math.max(1, cards.filter((c) => c.offsetTop === cards[0].offsetTop).length);
    const to = {
      ArrowLeft: at - 1,
      ArrowRight: at + 1,
      ArrowUp: at - columns,
      ArrowDown: at + columns,
      Home: 0,
      End: cards.length - 1,
    }[event.key];
    const card = cards[to ?? at];
    if (!card) return;
    this.#focus(card);
    if (event.shiftKey) this.stretched(card.dataset.id ?? "");
  }
}
