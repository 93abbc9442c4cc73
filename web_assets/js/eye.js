// What the simulated robot's front sees: a second picture of the 3-D view, drawn by viser itself.

import { $, setStyle, text } from "./dom.js";
import { angles } from "./motion.js";

/** @import { Draw } from "./painter.js" */
/** @import { Panes } from "./panes.js" */
/** @import { Batch3D, Camera3D, Tick, Viser } from "../types/page.js" */

/** Where the eye is in the trunk's frame, m, and its angle of view, upright. */
const FRONT = [0.29, 0, 0.02];
const FOV = 62;
/** m: nearer is not seen. */
const NEAR = 0.02;
/** ms without a picture after which it is said that there is none. */
const NONE = 4000;
/** ms between looks at where its frame is. */
const AGAIN = 200;

/**
 * Where the horizon is in a picture: how far above its middle, in halves of its height, and turned
 * by how much (rad, clockwise).
 *
 * @param {number[]} quat of the trunk
 */
export function horizon(quat) {
  const { roll, pitch } = angles(quat);
  const far = Math.tan((FOV * Math.PI) / 360);
  return { up: Math.tan(Math.max(-1.4, Math.min(1.4, pitch))) / far, turn: -roll };
}

export class Eye {
  #figure = $("#eye");
  #back = $("#eye-back");
  #at = { x: 0, y: 0, width: 0, height: 0 };
  /** @type {Viser | null} */
  #viser = null;
  /** @type {Camera3D | null} */
  #camera = null;
  #drawn = 0;

  /** @param {Panes} panes @param {() => Tick | null} newest @param {() => boolean} there */
  constructor(panes, newest, there) {
    this.panes = panes;
    this.newest = newest;
    this.there = there;
    setInterval(() => this.#place(), AGAIN);
  }

  /** Where its frame is now: that makes room for other things. */
  #place() {
    if (this.#figure.hidden) return;
    const { offsetLeft: x, offsetTop: y } = this.#figure;
    const { clientWidth: width, clientHeight: height } = this.#figure;
    const at = { x: x + 1, y: y + 1, width, height }; // within its border
    if (JSON.stringify(at) === JSON.stringify(this.#at)) return;
    this.#at = at;
    const [left, top] = [`${x}px`, `${y}px`];
    setStyle(this.#back, { left, top, width: `${width}px`, height: `${height}px` });
    this.#viser?.requestRender();
  }

  /** Every frame, while it is wanted. @param {Viser} viser */
  draw(viser) {
    if (viser !== this.#viser) this.#camera = null; // the view was loaded anew
    this.#viser = viser;
    if (this.#figure.hidden) {
      this.#figure.hidden = this.#back.hidden = false;
      this.#place();
      this.#drawn = performance.now();
      this.panes.more.add(this.#picture);
      viser.requestRender();
    }
    const none = performance.now() - this.#drawn > NONE;
    const says = none ? "This 3-D view draws no second picture" : "What its front sees";
    text($("figcaption", this.#figure), this.there() ? says : "The robot is hidden: show it");
  }

  /** No longer wanted. */
  remove() {
    if (this.#figure.hidden) return;
    this.#figure.hidden = this.#back.hidden = true;
    this.panes.more.delete(this.#picture);
    this.#viser?.requestRender();
  }

  #picture = (/** @type {Draw} */ draw) => {
    const [viser, tick] = [this.#viser, this.newest()];
    const trunk = viser && drawn(viser);
    if (!viser || !tick || !trunk || !this.there() || !this.#at.width) return;
    const camera = (this.#camera ??= viser.camera.clone());
    const place = (/** @type {number} */ x, /** @type {number} */ y, /** @type {number} */ z) =>
      trunk.localToWorld(
        Object.assign(camera.position.clone(), { x, y, z }).applyMatrix4(trunk.getMatrixAt(0)),
      );
    const [x, y, z] = FRONT;
    camera.fov = FOV;
    camera.near = NEAR;
    camera.aspect = 0; // so that its lens is made anew
    camera.position.copy(place(x, y, z));
    camera.up.copy(place(x, y, z + 1).sub(camera.position));
    camera.lookAt(place(x + 1, y, z));
    const { up, turn } = horizon(tick.robot.base_quat); // behind it is five times as high
    const shift = `translateY(${(-10 * up).toFixed(2)}%)`;
    setStyle($("i", this.#back), { transform: `rotate(${turn.toFixed(4)}rad) ${shift}` });
    const laidOver = viser.nodeRefFromName["/reference"];
    if (laidOver) laidOver.visible = false; // it would look out of its head
    draw(camera, this.#at);
    if (laidOver) laidOver.visible = true;
    this.#drawn = performance.now();
  };
}

/**
 * The mesh of the trunk, as it is drawn: a tick may be ahead of it.
 *
 * @param {Viser} viser @returns {Batch3D | null}
 */
function drawn({ nodeRefFromName }) {
  let found = null;
  nodeRefFromName["/robot/trunk"]?.traverse((thing) => {
    if ("getMatrixAt" in thing) found = thing;
  });
  return found;
}
