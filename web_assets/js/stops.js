// A stop until it is confirmed: sent again and again, by the socket and by HTTP.

const AGAIN = 300; // ms without a confirmation until it is sent again, both ways

export class Stops {
  #number = 0;
  #pressed = 0;
  /** @type {ReturnType<typeof setInterval> | undefined} */
  #again;

  /**
   * @param {{ send: (message: object) => boolean, post: () => Promise<boolean>,
   *   confirmed: (ms: number) => void }} ways send: whether the socket took it. post: whether it
   *   was applied. confirmed: told how long that took.
   */
  constructor(ways) {
    this.ways = ways;
  }

  /** Whether one is on its way. */
  get waiting() {
    return this.#again !== undefined;
  }

  /** Emergency stop. */
  press() {
    if (!this.waiting) this.#pressed = performance.now();
    clearInterval(this.#again);
    this.#number += 1;
    this.#again = setInterval(() => this.#insist(), AGAIN);
    if (!this.#send()) this.#insist();
  }

  /** The socket is there again. */
  reconnected() {
    if (this.waiting) this.#send();
  }

  /**
   * The studio has applied a stop: of those pressed only the last counts, for the robot may have
   * been released after an earlier one.
   *
   * @param {number} number
   */
  confirm(number) {
    if (!this.waiting || number !== this.#number) return;
    clearInterval(this.#again);
    this.#again = undefined;
    this.ways.confirmed(performance.now() - this.#pressed);
  }

  #send() {
    return this.ways.send({ type: "stop", number: this.#number });
  }

  #insist() {
    const number = this.#number;
    this.#send();
    this.ways.post().then(
      (applied) => applied && this.confirm(number),
      () => {},
    );
  }
}
