// A scene from above: props, the robot and where it looks, and the trail of its feet.

import { el } from "./dom.js";
import { angles } from "./motion.js";

/** @import { SceneInfo, State, Tick } from "../types/page.js" */

/** px, of a side. */
const SIZE = 168;
/** m beyond the outermost thing; the least that is shown. */
const MARGIN = 0.6;
const LEAST = 3.5;
/** Steps of a foot that are remembered. */
const TRAIL = 400;
/** m: a robot that went further in a period was set there. */
const JUMP = 0.5;

/**
 * The square (m) that holds the robot and all props: its middle and its side.
 *
 * @param {number[][]} points x, y
 */
export function bounds(points) {
  const [low, high] = [Math.min, Math.max].map((of) =>
    [0, 1].map((i) => of(...points.map((point) => point[i]))),
  );
  const side = Math.max(LEAST, high[0] - low[0], high[1] - low[1]) + 2 * MARGIN;
  return { middle: [(low[0] + high[0]) / 2, (low[1] + high[1]) / 2], side };
}

export class SceneMap {
  canvas = el("canvas", { class: "scene-map", width: 2 * SIZE, height: 2 * SIZE, role: "img" });
  /** @type {number[][]} */
  #trail = [];
  #stood = [1, 1, 1, 1];
  /** @type {number[] | null} */
  #last = null;

  constructor() {
    this.canvas.setAttribute("aria-label", "The scene from above; ahead at the start is up");
  }

  /** Where feet come down. @param {Tick} tick */
  add({ robot, mode }) {
    const [x, y] = robot.base_pos;
    if (this.#last && Math.hypot(x - this.#last[0], y - this.#last[1]) > JUMP) this.#trail = [];
    this.#last = [x, y];
    if (mode === "replay") return;
    robot.foot_contact.forEach((stands, i) => {
      if (stands > 0.5 && this.#stood[i] <= 0.5) this.#trail.push(robot.foot_pos_w[i].slice(0, 2));
      this.#stood[i] = stands;
    });
    this.#trail.splice(0, this.#trail.length - TRAIL);
  }

  /** @param {SceneInfo} scene @param {State["props"]} moved @param {Tick} tick */
  draw(scene, moved, { robot }) {
    const pen = this.canvas.getContext("2d");
    if (!pen) return;
    const props = scene.props.map((prop) => {
      const [x, y, , w, i, j, k] = moved[prop.name] ?? [prop.x, prop.y, 0, 1, 0, 0, 0];
      const yaw = prop.name in moved ? angles([w, i, j, k]).yaw : prop.yaw;
      return { ...prop, x, y, yaw };
    });
    const corners = props.flatMap(({ x, y, half }) => [
      [x - half[0], y - half[1]],
      [x + half[0], y + half[1]],
    ]);
    const { middle, side } = bounds([robot.base_pos, [0, 0], ...corners]);
    const scale = this.canvas.width / side;
    pen.resetTransform();
    pen.clearRect(0, 0, this.canvas.width, this.canvas.height);
    // x, ahead at the start, is up; y, to the left, is left.
    pen.setTransform(0, -scale, -scale, 0, this.canvas.width / 2, this.canvas.height / 2);
    pen.translate(-middle[0], -middle[1]);
    for (const { x, y, yaw, half, round, color, moves } of props) {
      pen.fillStyle = `rgb(${color.join(" ")} / ${moves ? 1 : 0.55})`;
      pen.beginPath();
      if (round) pen.arc(x, y, Math.max(half[0], 0.06), 0, 7);
      else {
        const [c, s] = [Math.cos(yaw), Math.sin(yaw)];
        for (const [a, b] of [
          [1, 1],
          [-1, 1],
          [-1, -1],
          [1, -1],
        ])
          // prettier-ignore
          pen.lineTo(x + a * half[0] * c - b * half[1] * s, y + a * half[0] * s + b * half[1] * c);
      }
      pen.fill();
    }
    const style = getComputedStyle(this.canvas);
    pen.fillStyle = style.color;
    pen.globalAlpha = 0.5;
    for (const [x, y] of this.#trail) pen.fillRect(x - 0.02, y - 0.02, 0.04, 0.04);
    pen.globalAlpha = 1;
    const [x, y] = robot.base_pos;
    const { yaw } = angles(robot.base_quat);
    pen.fillStyle = style.getPropertyValue("--accent");
    pen.beginPath();
    for (const [r, turn] of [
      [0.34, 0],
      [0.26, 2.5],
      [0.26, -2.5],
    ])
      // prettier-ignore
      pen.lineTo(x + r * Math.cos(yaw + turn), y + r * Math.sin(yaw + turn));
    pen.fill();
  }
}
