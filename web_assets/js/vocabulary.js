// Which human motion means what: the one table of the shipped mappers, drawn as stick figures.

/** @import { State, Tick } from "../types/page.js" */

import { $, $$, el } from "./dom.js";
import { angles } from "./motion.js";

/**
 * @typedef {object} Meaning
 * @property {string} id
 * @property {string} [style] counts where walking means that
 * @property {string} brief what the person does, in a word or two
 * @property {string} short what the robot then does, in a word
 * @property {string} you what the person does
 * @property {string} it what the robot then does
 * @property {string} svg
 */

/** @param {number} x @param {number} y */
const head = (x, y) => `<circle cx="${x}" cy="${y}" r="4.2"/>`;
/** @param {...string} points */
const line = (...points) => `<path d="M${points.join("L")}"/>`;
/** @param {string} path */
const arrow = (path) => `<path d="${path}" opacity=".7"/>`;

const UPRIGHT = head(20, 8) + line("20 12", "20 24");
const LEGS = line("15 37", "20 24", "25 37");
const MARCHING_ARMS = line("14 20", "15 15", "20 13", "25 17", "29 15");
const TWISTED_ARMS = line("12 16", "20 13", "28 17");
const MARCHING_LEGS = line("20 37", "20 24", "27 25", "27 32");
const TURNING = arrow("M8 31a13 5 0 0 0 22 3m0 0l-5 -1m5 1l-1 -5");

/** @type {Meaning[]} */
export const VOCABULARY = [
  {
    id: "stand",
    brief: "Stand",
    short: "stands",
    you: "Stand upright, quiet",
    it: "stands",
    svg: UPRIGHT + line("14 23", "15 17", "20 14", "25 17", "26 23") + LEGS,
  },
  {
    id: "tilt",
    brief: "Lean, twist",
    short: "tilts",
    you: "Lean, bend or twist your trunk",
    it: "tilts the same way",
    svg: head(29, 10) + line("27 14", "20 24") + line("20 23", "22 17", "27 14", "32 19") + LEGS,
  },
  {
    id: "crouch",
    brief: "Bend knees",
    short: "crouches",
    you: "Bend your knees a little",
    it: "crouches",
    svg:
      head(20, 13) +
      line("20 17", "19 27") +
      line("14 27", "15 21", "20 18", "25 21", "26 27") +
      line("15 37", "14 30", "19 27", "26 30", "25 37"),
  },
  {
    id: "sit",
    brief: "Squat deep",
    short: "sits",
    you: "Squat deep, or sit",
    it: "sits, both paws free",
    svg:
      head(18, 15) +
      line("18 19", "16 30") +
      line("17 21", "24 22", "30 20") +
      line("16 30", "26 29", "25 37"),
  },
  {
    id: "reach",
    brief: "Raise an arm",
    short: "lifts a paw",
    you: "Raise or reach with an arm",
    it: "lifts the paw of that side",
    svg:
      head(20, 9) +
      line("20 13", "20 24") +
      line("20 14", "27 10", "31 3") +
      line("20 14", "14 18", "13 24") +
      LEGS,
  },
  {
    id: "walk",
    style: "march",
    brief: "March",
    short: "walks",
    you: "March in place",
    it: "walks: faster steps, faster pace",
    svg: UPRIGHT + MARCHING_ARMS + line("20 37", "20 24", "28 25", "27 33"),
  },
  {
    id: "walk",
    style: "circles",
    brief: "Circle hands",
    short: "walks",
    you: "Circle your hands in turn, as if pedalling",
    it: "walks: faster circles, faster pace",
    svg:
      UPRIGHT +
      line("20 14", "17 20", "24 18") +
      line("20 14", "21 20", "29 15") +
      LEGS +
      arrow("M33 12a7 7 0 1 1 -6 -2m0 0l3 -2m-3 2l2 3"),
  },
  {
    id: "walk",
    style: "semantic",
    brief: "March high",
    short: "walks",
    you: "March in place, knees high",
    it: "walks: cadence and step height set its speed",
    svg:
      UPRIGHT +
      MARCHING_ARMS +
      line("20 37", "20 24", "29 22", "28 31") +
      line("35 37", "35 20") +
      line("32 23", "35 20", "38 23"),
  },
  {
    id: "turn",
    style: "march",
    brief: "March, twist",
    short: "turns",
    you: "Twist while marching",
    it: "turns that way",
    svg: UPRIGHT + TWISTED_ARMS + MARCHING_LEGS + TURNING,
  },
  {
    id: "turn",
    style: "circles",
    brief: "Circle, twist",
    short: "turns",
    you: "Twist while circling",
    it: "turns that way",
    svg: UPRIGHT + TWISTED_ARMS + LEGS + TURNING,
  },
  {
    id: "turn",
    style: "semantic",
    brief: "March, lean",
    short: "turns",
    you: "Twist or lean aside while marching",
    it: "turns that way",
    svg: UPRIGHT + TWISTED_ARMS + MARCHING_LEGS + TURNING,
  },
];

/**
 * The line of the table that a tick shows just now, by its id.
 *
 * @param {Pick<Tick, "human" | "expert" | "reference">} tick
 */
export function meaningOf({ human, expert, reference }) {
  if (!human || expert === "unknown") return null;
  if (expert === "walk" || expert === "sit") return expert;
  const [right, left] = reference.foot_contact;
  if (right < 0.5 || left < 0.5) return "reach";
  const { roll, pitch } = angles(reference.base_quat);
  if (Math.hypot(roll, pitch) > 0.1) return "tilt";
  return reference.base_pos[2] < 0.25 ? "crouch" : "stand";
}

/** Put the table on the page. */
export function startVocabulary() {
  for (const { id, style, brief, short, you, it, svg } of VOCABULARY) {
    const hidden = style !== undefined && style !== "march";
    const title = `${you}: the robot ${it}`;
    const row = el("li", { "data-id": id, "data-style": style, hidden, title });
    row.innerHTML = `<svg viewBox="0 0 40 40" aria-hidden="true">${svg}</svg>`;
    row.append(el("b", {}, brief), el("span", {}, short));
    $("#vocabulary").append(row);
  }
}

/** Only the lines of the style that walking means. @param {State} state */
export function drawStyle({ style }) {
  for (const row of $$("#vocabulary li[data-style]")) row.hidden = row.dataset.style !== style;
}

/** The line that a tick shows is marked. @param {Tick} tick */
export function drawMeaning(tick) {
  const meaning = meaningOf(tick);
  for (const row of $$("#vocabulary li")) row.classList.toggle("now", row.dataset.id === meaning);
}
