// A push: from the simulated robot to the pointer an arrow, and a force that way while it is held.

import { Arrow } from "./arrow.js";
import { toast } from "./dom.js";
import { onPlane, onScreen } from "./screen.js";
import { capital } from "./words.js";

/** @import { Viser } from "../types/page.js" */
/** @import { Studio } from "./studio.js" */
/** @import { View } from "./view.js" */

/** N for each m of the arrow, and at most (`sim/pull.py`). */
const STIFF = 120;
const MOST = 60;
/** ms between two pushes; s that one lasts, should no other come. */
const EVERY = 100;
const LASTS = 0.35;
/** ms after which a page knows of a stop. */
const SAID = 400;
/** m around the robot's middle in which it is taken hold of; at least so many px. */
const REACH = 0.4;
const LEAST = 40;
/** m: how far an arrow goes that points over the horizon. */
const BEYOND = 10;

/**
 * The force (N) of an arrow (m), level.
 *
 * @param {number} x @param {number} y @returns {[number, number, number]}
 */
export function forceOf(x, y) {
  const long = Math.hypot(x, y);
  const share = long ? Math.min(STIFF * long, MOST) / long : 0;
  return [share * x, share * y, 0];
}

export class Pusher {
  /** @type {[number, number, number]} */
  #force = [0, 0, 0];
  #arrow = new Arrow("push-arrow");

  /** @param {Studio} studio @param {View} view */
  constructor(studio, view) {
    this.studio = studio;
    this.view = view;
  }

  /** Where the robot is drawn, m, z up. @param {Viser} viser */
  #middle({ nodeRefFromName }) {
    const [figure, caption] = [nodeRefFromName["/robot"], nodeRefFromName["/robot/caption"]];
    const tick = this.studio.tick;
    if (!figure || !caption || !tick) return null;
    const { position: by } = figure;
    return [caption.position.x + by.x, caption.position.y + by.y, tick.robot.base_pos[2] + by.z];
  }

  /**
   * Take hold where the pointer went down.
   *
   * @param {Window} inner @param {PointerEvent} event @param {PointerEvent} [now] where it is
   */
  begin(inner, event, now = event) {
    const viser = this.view.viser;
    const middle = viser && this.#middle(viser);
    if (!viser || !middle) return;
    const pane = this.view.panes.of(viser, "robot");
    const [x, y] = onScreen(viser, pane, middle);
    const [, above] = onScreen(viser, pane, [middle[0], middle[1], middle[2] + REACH]);
    const reach = Math.max(LEAST, Math.abs(y - above));
    if (Math.hypot(event.clientX - x, event.clientY - y) > reach) {
      toast("Take hold of the simulated robot to push it");
      return;
    }
    const move = (/** @type {PointerEvent} */ { clientX, clientY }) =>
      this.#aim(viser, clientX, clientY);
    const end = () => {
      clearInterval(timer);
      inner.removeEventListener("pointermove", move);
      for (const kind of ["pointerup", "pointercancel", "blur"])
        inner.removeEventListener(kind, end);
      this.#arrow.remove();
      this.#force = [0, 0, 0];
      if (!this.studio.state?.stopped) this.#send().catch(() => {});
    };
    let waits = false;
    const timer = setInterval(async () => {
      if (this.studio.state?.stopped) return end();
      if (waits) return;
      waits = true;
      await this.#send().catch((error) => {
        end();
        // A stop says itself that it came in between.
        setTimeout(() => this.studio.state?.stopped || toast(capital(error.message)), SAID);
      });
      waits = false;
    }, EVERY);
    inner.addEventListener("pointermove", move);
    for (const kind of ["pointerup", "pointercancel", "blur"]) inner.addEventListener(kind, end);
    this.#aim(viser, now.clientX, now.clientY);
  }

  #send() {
    return this.studio.api.post("/api/push", { force: this.#force, seconds: LASTS });
  }

  /** @param {Viser} viser @param {number} px @param {number} py */
  #aim(viser, px, py) {
    const middle = this.#middle(viser);
    if (!middle) return;
    const pane = this.view.panes.of(viser, "robot");
    const [x, y] = onScreen(viser, pane, middle);
    const at = onPlane(viser, pane, [px, py], middle[2], BEYOND);
    this.#force = forceOf(at[0] - middle[0], at[1] - middle[1]);
    const newtons = Math.hypot(...this.#force);
    // As long as the force; from there on the pointer is only followed.
    const tip = middle.map((c, i) => c + this.#force[i] / STIFF);
    const word = newtons < MOST - 0.5 ? `${newtons.toFixed(0)} N` : `${MOST} N, the most`;
    this.#arrow.draw([x, y], onScreen(viser, pane, tip), word, { on: [px, py] });
  }
}
