// Setting the simulated robot down elsewhere: the tool, and the way back to where it began.

import { $, attempt, setStyle, toast } from "./dom.js";

/** @import { Studio } from "./studio.js" */
/** @import { View } from "./view.js" */

export class PlaceDoor {
  #button = $("#place");

  /** @param {Studio} studio @param {() => View} view */
  constructor(studio, view) {
    this.studio = studio;
    this.view = view;
    this.#button.addEventListener("click", () => this.#set(!this.#on));
  }

  get #on() {
    return this.#button.getAttribute("aria-pressed") === "true";
  }

  /** @param {boolean} on */
  #set(on) {
    const { stopped, mode } = this.studio.state ?? {};
    if (on && !stopped && mode !== "idle")
      return toast("Stop the robot, or choose Idle, before you set it down elsewhere");
    this.#button.setAttribute("aria-pressed", String(on));
    $(".stage").classList.toggle("placing", on);
    const canvas = this.view().viser?.canvas;
    if (canvas) setStyle(canvas, { cursor: on ? "crosshair" : "" });
    if (on) toast("Press on the floor where it shall stand; drag to where it shall look");
  }

  /** Back to where its world begins, looking ahead. */
  home = () => attempt(() => this.studio.api.post("/api/place", { x: 0, y: 0, yaw: 0 }));

  keys = { Home: this.home };

  /** For the palette. */
  entries = [{ words: "Robot: reset its pose, where it began", key: "Home", run: this.home }];

  /** @param {Window} inner the view's own */
  listen(inner) {
    inner.addEventListener(
      "pointerdown",
      (event) => {
        if (event.button !== 0 || !this.#on) return;
        event.stopImmediatePropagation(); // else it turns the camera
        const end = lifted(inner); // it may go up while the rest is loaded
        attempt(async () => {
          const { place } = await import("./placing.js");
          const put = await place(this.studio, this.view(), inner, event, end).catch((why) => {
            this.#set(false); // it is not the time for it any more
            throw why;
          });
          if (put) this.#set(false);
        });
      },
      true,
    );
  }
}

/**
 * Where the pointer goes up; null where it is taken away.
 *
 * @param {Window} inner @returns {Promise<PointerEvent | null>}
 */
function lifted(inner) {
  const over = new AbortController();
  return new Promise((ended) => {
    const end = (/** @type {PointerEvent | null} */ event) => {
      over.abort();
      ended(event);
    };
    inner.addEventListener("pointerup", end, over);
    for (const kind of ["pointercancel", "blur"])
      inner.addEventListener(kind, () => end(null), over);
  });
}
