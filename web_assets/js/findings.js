// What was found in a take, as the bench says and offers it: flaws to cut out, a lag to take out.

import { el } from "./dom.js";
import { FRAME } from "./motion.js";
import { counted } from "./words.js";

/** @import { Alignment, Review, Take } from "../types/page.js" */
/** @import { Actions } from "./bench.js" */

const FLAWS = 40; // with a button of their own; the next come up as these are cut out

/** @param {Review} review @param {Actions} on */
export function flaws({ suggestions }, on) {
  if (!suggestions.length) return [];
  const all = suggestions.map(({ start, message }) => `${start.toFixed(2)} s: ${message}`);
  const each = suggestions.length > 1 ? suggestions.slice(0, FLAWS) : [];
  return [
    el(
      "button",
      { title: all.join("\n"), onclick: () => on.clean() },
      `Cut out ${counted(suggestions.length, "flaw")}`,
    ),
    ...each.map(({ start, message }, i) =>
      el(
        "button",
        {
          class: "one",
          title: `Cut out this one only: ${message}`,
          "aria-label": `Cut out at ${start.toFixed(2)} s: ${message}`,
          onclick: () => on.clean([i]),
        },
        `${start.toFixed(1)} s`,
      ),
    ),
  ];
}

/**
 * How late the person is by what was found, where that is worth an edit: more than half a frame,
 * and nobody said to leave it. s, or 0.
 *
 * @param {Pick<Take, "lag">} take
 * @param {Pick<Alignment, "lag">} before
 * @param {Pick<Alignment, "lag">} found
 */
export function lateBy(take, before, found) {
  const late = found.lag - before.lag;
  return take.lag !== 0 && Math.abs(late) > FRAME / 2 ? late : 0;
}

/**
 * How a take stands with its lag, in words.
 *
 * @param {Pick<Take, "lag" | "warped">} take
 * @param {number} agreement correlation, as it is aligned now
 */
export function standing({ lag, warped }, agreement) {
  if (lag === 0) return "Left as acted";
  const agrees = `agrees ${agreement.toFixed(2)}`;
  return lag
    ? `Aligned by ${lag.toFixed(2)} s${warped ? " and warped" : ""} · ${agrees}`
    : `In time · ${agrees}`;
}

/** @param {Take} take @param {Review} review @param {boolean} aligned @param {Actions} on */
export function alignment(take, { before, found }, aligned, on) {
  if (!before || !found) return [el("span", { class: "note" }, "nothing moves: no lag to find")];
  const late = lateBy(take, before, found);
  const warp = (/** @type {object} */ more) =>
    el(
      "button",
      { title: "Also even out tempo", onclick: () => on.align(true), ...more },
      "with warp",
    );
  if (late) {
    const numbers = `${before.correlation.toFixed(2)} → ${found.correlation.toFixed(2)}`;
    return [
      el(
        "span",
        {},
        "You are ",
        el("b", {}, `${late.toFixed(2)} s`),
        ` late · agreement ${numbers}`,
      ),
      el("button", { class: "main", id: "align-accept", onclick: () => on.align(false) }, "Align"),
      warp({}),
      el(
        "button",
        { title: "Leave it as it was acted", id: "align-refuse", onclick: on.leave },
        "Leave",
      ),
    ];
  }
  const words = el("span", {}, standing(take, before.correlation));
  if (!take.lag) return [words, el("button", { onclick: () => on.align(false) }, "Align")];
  const compare = {
    "aria-pressed": String(!aligned),
    title: "Show it as it was recorded, or as it is aligned",
    onclick: on.compare,
  };
  const warpIt = take.warped ? [] : [warp({ id: "align-warp" })];
  return [words, el("button", compare, aligned ? "Before" : "After"), ...warpIt];
}
