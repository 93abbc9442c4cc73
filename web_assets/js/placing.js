// Setting the robot down: a press on the floor says where, dragged on, where it looks.

import { Arrow } from "./arrow.js";
import { toast } from "./dom.js";
import { angles } from "./motion.js";
import { onPlane, onScreen } from "./screen.js";
import { toThree } from "./view-camera.js";

/** @import { Studio } from "./studio.js" */
/** @import { View } from "./view.js" */
/** @import { Viser } from "../types/page.js" */

/** m: less far dragged, it looks where it looked before. */
const MEANT = 0.15;
/** m from the robot: as far as a floor is drawn. */
const FLOOR = 7;
/** m: how large the mark is. */
const ROUND = 0.22;

/**
 * Where it shall stand, and look, if two points (m, x and y) are where the pointer went down and
 * up; or why not.
 *
 * @param {number[]} down @param {number[]} up @param {number[]} robot where it is
 * @returns {{ x: number, y: number, yaw: number | null } | string}
 */
export function asked(down, up, robot) {
  const far = Math.hypot(down[0] - robot[0], down[1] - robot[1]);
  if (!(far < FLOOR)) return "Press on the floor, not so far away";
  const [dx, dy] = [up[0] - down[0], up[1] - down[1]];
  const yaw = Math.hypot(dx, dy) > MEANT ? Math.atan2(dy, dx) : null;
  return { x: down[0], y: down[1], yaw };
}

/**
 * From the pointer going down to its going up. Whether the robot was set down.
 *
 * @param {Studio} studio @param {View} view @param {Window} inner
 * @param {PointerEvent} event @param {Promise<PointerEvent | null>} lifted
 */
export async function place(studio, view, inner, event, lifted) {
  const { viser } = view;
  const pane = viser && view.panes.of(viser, "robot");
  if (!viser || !pane || !studio.tick) return false;
  const at = (/** @type {{ clientX: number, clientY: number }} */ { clientX, clientY }) =>
    onPlane(viser, pane, [clientX, clientY], 0);
  const down = at(event);
  const mark = new Arrow("place-mark");
  const pixel = (/** @type {number[]} */ [x, y]) => onScreen(viser, pane, [x, y, 0]);
  const ring = Array.from({ length: 24 }, (_, i) => (i * Math.PI) / 12).map((turn) =>
    pixel([down[0] + ROUND * Math.cos(turn), down[1] + ROUND * Math.sin(turn)]),
  );
  const draw = (/** @type {number[]} */ to) => {
    const meant = Math.hypot(to[0] - down[0], to[1] - down[1]) > MEANT;
    mark.draw(pixel(down), pixel(meant ? to : down), meant ? "looks here" : "here", { ring });
  };
  const move = (/** @type {PointerEvent} */ moved) => draw(at(moved));
  if (Number.isFinite(down[0])) {
    draw(down);
    inner.addEventListener("pointermove", move);
  }
  const end = await lifted;
  const up = end && at(end);
  inner.removeEventListener("pointermove", move);
  mark.remove();
  if (!up) return false;
  const { base_pos, base_quat } = studio.tick.robot;
  const body = asked(inWorld(viser, down), inWorld(viser, up), base_pos);
  if (typeof body === "string") {
    toast(body);
    return false;
  }
  await studio.api.post("/api/place", body);
  const degrees = ((body.yaw ?? angles(base_quat).yaw) * 180) / Math.PI;
  const [x, y] = [body.x, body.y].map((c) => c.toFixed(2));
  toast(`Set down at ${x}, ${y} m, looking ${degrees.toFixed(0)}°`);
  return true;
}

/**
 * x, y in the robot's world of a point on the view's floor.
 *
 * @param {Viser} viser @param {number[]} point
 */
function inWorld(viser, [x, y]) {
  const world = viser.nodeRefFromName["/robot/world"];
  if (!world) return [NaN, NaN];
  return world.worldToLocal(toThree(viser, [x, y, 0])).toArray();
}
