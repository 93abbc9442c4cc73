// Pushing the simulated robot by the mouse: Shift and drag, or the tool; the rest is loaded then.

import { $, attempt } from "./dom.js";

/** @import { Pusher } from "./pushing.js" */
/** @import { Studio } from "./studio.js" */
/** @import { View } from "./view.js" */

export class PushDoor {
  #button = $("#push");
  /** @type {Pusher | null} */
  #pusher = null;

  /** @param {Studio} studio @param {() => View} view */
  constructor(studio, view) {
    this.studio = studio;
    this.view = view;
    this.#button.addEventListener("click", () =>
      this.#button.setAttribute("aria-pressed", String(!this.#on)),
    );
  }

  keys = { 7: () => this.#button.click() };

  get #on() {
    return this.#button.getAttribute("aria-pressed") === "true";
  }

  /** @param {Window} inner the view's own */
  listen(inner) {
    inner.addEventListener(
      "pointerdown",
      (event) => {
        if (event.button !== 0 || !(this.#on || event.shiftKey)) return;
        event.stopImmediatePropagation(); // else it turns the camera
        attempt(() => this.#push(inner, event));
      },
      true,
    );
  }

  /** @param {Window} inner @param {PointerEvent} event */
  async #push(inner, event) {
    let up = false;
    let at = event;
    const move = (/** @type {PointerEvent} */ moved) => (at = moved);
    inner.addEventListener("pointerup", () => (up = true), { once: true });
    inner.addEventListener("pointermove", move); // it may go on while the rest is loaded
    if (!this.#pusher) {
      const { Pusher } = await import("./pushing.js");
      this.#pusher = new Pusher(this.studio, this.view());
    }
    inner.removeEventListener("pointermove", move);
    if (!up) this.#pusher.begin(inner, event, at);
  }
}
