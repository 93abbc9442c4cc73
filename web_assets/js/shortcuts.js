// The list of keys, in a dialog.

import { $, el } from "./dom.js";
import { DRIVE } from "./keys.js";

const ROWS = [
  ["Esc", "emergency stop, wherever the focus is; closes this while the robot is still"],
  ["Space", "emergency stop, outside controls"],
  ["R", "reset: stand up"],
  ["Enter", "arm: follow again"],
  ["1–6", "camera: front, side, behind, above, chase (with the robot), split (person | robots)"],
  ["7", "push tool: drag the simulated robot in the view (Shift and drag without it)"],
  ["Home", "reset the robot's pose, where its world begins, while it is stopped or idle"],
  ["8 9", "a scene: again from its beginning, the next one"],
  ["T", "dark or light"],
  ["H", "record, and end the take"],
  ["J", "plots"],
  ["U", "the library: all takes, many at once (Shift, Ctrl A, Delete), the bin"],
  ["Ctrl K", "everything the page can do, by typing"],
  ["?", "this help"],
  ["G V M", "collecting: start, end the preview, abort"],
  ["K B N", "collecting: keep, redo, next"],
  ["P , . L", "a clip, a take, the review: play, a frame back or on, loop"],
  ["0", "a clip, a take: again, from the start"],
  ["I O Z Y", "reviewing: trim here, undo, redo"],
  ...DRIVE.map(([key, what]) => [key, `keyboard driving: ${what}`]),
];

/** Not modal: the stop button must stay within reach. */
export function show() {
  if (!$("#keys").children.length)
    for (const [key, what] of ROWS) $("#keys").append(el("kbd", {}, key), el("span", {}, what));
  const dialog = /** @type {HTMLDialogElement} */ ($("#shortcuts"));
  dialog.show();
  dialog.scrollTop = 0; // the focus, on a button at its end, has scrolled it there
}
