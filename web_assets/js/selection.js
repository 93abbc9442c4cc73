// Which rows of a list are chosen: one by one, from here to there, all of them.

export class Selection {
  /** @type {Set<string>} */
  #chosen = new Set();
  /** From where a stretch goes. @type {string | null} */
  #anchor = null;

  /** In the list's order. @param {string[]} order */
  of(order) {
    return order.filter((id) => this.#chosen.has(id));
  }

  get size() {
    return this.#chosen.size;
  }

  /** @param {string} id */
  has(id) {
    return this.#chosen.has(id);
  }

  /** One row; a stretch goes from it from now on. @param {string} id @param {boolean} on */
  set(id, on) {
    if (on) this.#chosen.add(id);
    else this.#chosen.delete(id);
    this.#anchor = id;
  }

  /**
   * All from the row that was set last to this one; that one alone where it is not there.
   *
   * @param {string[]} order
   * @param {string} id
   */
  stretch(order, id) {
    const from = order.indexOf(this.#anchor ?? "");
    const to = order.indexOf(id);
    if (from < 0) this.set(id, true);
    else
      for (const one of order.slice(Math.min(from, to), Math.max(from, to) + 1))
        this.#chosen.add(one);
  }

  /** @param {string[]} order */
  all(order) {
    for (const id of order) this.#chosen.add(id);
  }

  clear() {
    this.#chosen.clear();
    this.#anchor = null;
  }

  /** Rows that are no longer there are not chosen. @param {string[]} order */
  retain(order) {
    const there = new Set(order);
    for (const id of this.#chosen) if (!there.has(id)) this.#chosen.delete(id);
  }
}
