// Buttons that have just come where others were: a second click, or a late one, was not for them.

const UNMEANT = 600; // ms

export class Unmeant {
  #shown = "";
  #since = -Infinity;

  /**
   * What is shown now, in its order; whether others were a moment ago.
   *
   * @param {string} shown @param {number} now ms
   */
  draw(shown, now) {
    if (shown !== this.#shown) this.#since = now;
    this.#shown = shown;
    return this.is(now);
  }

  /** @param {number} now ms */
  is(now) {
    return now - this.#since < UNMEANT;
  }
}
