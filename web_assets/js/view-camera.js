// The view's camera: which one it is, where figures stand for it, and how it follows the robot.

import { laid, placeOf, stand, turnBy, wrapped } from "./cameras.js";
import { $, calm, press, setStyle } from "./dom.js";
import { angles } from "./motion.js";
import { halves } from "./panes.js";

/** @import { CameraName, Figure } from "./cameras.js" */
/** @import { Looks } from "./looks.js" */
/** @import { Panes } from "./panes.js" */
/** @import { Pose, Tick, Viser } from "../types/page.js" */

const FIGURES = /** @type {Figure[]} */ (["human", "reference", "robot"]);
/** rad from straight down: it looks up at nothing, so that it stays over the floor. */
const LOWEST = Math.PI / 2 - 0.02;
/** m: how near and far it goes, and how far from the middle it may look. */
const NEAR = 0.5;
const FAR = 14;
const ROOM = 6;
/** m: so deep, nothing is seen. */
const AWAY = -1000;

export class ViewCamera {
  name = /** @type {CameraName} */ ("front");
  /** Heading (rad) that it is behind; null before it chases. @type {number | null} */
  #behind = null;
  #then = 0;
  /** The camera that is used. */
  #used = this.name;
  /** @type {[[number, number], boolean]} */
  #view = [[1, 1], false];

  /** @param {() => Tick | null} newest @param {Looks} looks of the figures @param {Panes} panes */
  constructor(newest, looks, panes) {
    this.newest = newest;
    this.looks = looks;
    this.panes = panes;
    const kept = localStorage.getItem("camera");
    if (kept && document.querySelector(`[data-camera="${kept}"]`))
      this.name = /** @type {CameraName} */ (kept);
  }

  /** Whoever collects has to see what to act out. @returns {CameraName} */
  get #wanted() {
    return this.name === "chase" && this.newest()?.mode === "collect" ? "front" : this.name;
  }

  /** Whether a figure is to be seen. @param {string} figure */
  shows(figure) {
    if (this.looks.of(figure) === "hidden") return false;
    return placeOf(this.#used, this.#beside(figure)) !== null;
  }

  /** In whose place a figure stands. @param {string} figure @returns {Figure} */
  #beside(figure) {
    const over = figure === "reference" && this.looks.on("overlay");
    return over ? "robot" : /** @type {Figure} */ (figure);
  }

  /**
   * Stand there.
   *
   * @param {Viser} viser
   * @param {[number, number]} size of the view, px
   * @param {boolean} props whether there are any
   * @param {boolean} glide
   */
  look(viser, size, props, glide) {
    const control = viser.cameraControl;
    if (!control) return;
    control.maxPolarAngle = LOWEST;
    control.minDistance = NEAR;
    viser.configuredMaxOrbitDistance = FAR;
    this.#view = [size, props];
    const name = (this.#used = this.#wanted);
    const split = (this.panes.split = name === "split");
    this.panes.covered = split ? covered() * size[0] : 0;
    const [width, height] = split ? robotsOf(size, this.panes.covered) : size;
    const { eye, at, aside } = stand(name, width / height, props, split ? 0 : covered(), size[1]);
    const [from, to] = [eye, at].map((point) => toThree(viser, point));
    const glides = glide && !calm() && name !== "chase";
    control.setLookAt(from.x, from.y, from.z, to.x, to.y, to.z, glides);
    control.setFocalOffset(-aside, 0, 0, glides);
    this.#behind = name === "chase" ? 0 : null;
    viser.requestRender();
    press($(".cameras"), "camera", this.name);
    $(".stage").dataset.camera = name;
    $(".stage").classList.toggle("upright", size[0] < size[1]);
    setStyle($(".stage"), { "--half": `${halves(...size, this.panes.covered)[1].x}px` });
    localStorage.setItem("camera", this.name);
  }

  /** Every frame. @param {Viser} viser */
  follow(viser) {
    const now = performance.now();
    const dt = Math.min(0.5, (now - this.#then) / 1000);
    this.#then = now;
    if (this.#wanted !== this.#used) this.look(viser, ...this.#view, false);
    for (const figure of FIGURES) this.#stand(viser, figure);
    this.#chase(viser, dt);
    this.#overFloor(viser);
  }

  /**
   * Put a figure where it stands for this camera, or out of sight: viser sets each frame anew what
   * is visible. One that is laid over the robot heads as it does, so that what is left between the
   * two is how they stand.
   *
   * @param {Viser} viser @param {Figure} figure
   */
  #stand({ nodeRefFromName, requestRender }, figure) {
    const node = nodeRefFromName[`/${figure}`];
    const beside = this.#beside(figure);
    const column = nodeRefFromName[`/${figure}/caption`]?.position;
    const place = nodeRefFromName[`/${beside}/caption`]?.position;
    if (!node || !column || !place) return;
    const tick = this.newest();
    const turn = beside === figure || !tick ? 0 : headingBetween(tick.reference, tick.robot);
    const [x, y] = placeOf(this.#used, beside) ?? [place.x, place.y];
    const to = laid([column.x, column.y], [x, y], turn);
    const z = this.shows(figure) ? 0 : AWAY;
    const { position: at, quaternion } = node;
    const moved = Math.abs(at.x - to[0]) + Math.abs(at.y - to[1]) + Math.abs(at.z - z);
    if (moved + Math.abs(quaternion.z - Math.sin(turn / 2)) < 1e-6) return;
    Object.assign(at, { x: to[0], y: to[1], z });
    quaternion.set(0, 0, Math.sin(turn / 2), Math.cos(turn / 2));
    requestRender();
  }

  /** Turn with the robot; a person may turn it besides. @param {Viser} viser @param {number} dt */
  #chase({ cameraControl }, dt) {
    const tick = this.newest();
    if (this.#behind === null || !tick || !cameraControl) return;
    const off = wrapped(angles(tick.robot.base_quat).yaw - this.#behind);
    const turn = turnBy(off, dt, calm());
    if (Math.abs(turn) < 1e-4) return;
    this.#behind += turn;
    cameraControl.rotate(turn, 0, false);
  }

  /** Whatever was dragged, it looks at what is over the floor. @param {Viser} viser */
  #overFloor({ camera, cameraControl }) {
    if (!cameraControl?.getTarget) return;
    const at = cameraControl.getTarget(camera.position.clone());
    const inside = (/** @type {number} */ c) => Math.min(ROOM, Math.max(-ROOM, c));
    const [x, y, z] = [inside(at.x), Math.min(3, Math.max(0, at.y)), inside(at.z)];
    if (x !== at.x || y !== at.y || z !== at.z) cameraControl.moveTo(x, y, z, false);
  }
}

/** rad from one's heading to the other's. @param {Pose} from @param {Pose} to */
const headingBetween = (from, to) =>
  wrapped(angles(to.base_quat).yaw - angles(from.base_quat).yaw);

/** px of the robots' part of a split view. @param {[number, number]} size @param {number} left */
function robotsOf([width, height], left) {
  const [, robots] = halves(width, height, left);
  return [robots.width, robots.height];
}

/** The share of the view's left that is covered by what is to be done; of narrow views, none. */
function covered() {
  const { offsetLeft, offsetWidth, offsetParent } = $("#scene-over");
  const share = offsetParent ? (offsetLeft + offsetWidth) / offsetParent.clientWidth : 0;
  return share < 0.5 ? share : 0;
}

/**
 * viser's world is z up, three.js' is y up: (x, y, z) is drawn at (x', y', z') = turn(x, y, z).
 *
 * @param {Viser} viser
 * @param {number[]} point
 */
export function toThree({ camera, nodeRefFromName }, [x, y, z]) {
  const point = Object.assign(camera.position.clone(), { x, y, z });
  return nodeRefFromName[""]?.localToWorld(point) ?? point;
}
