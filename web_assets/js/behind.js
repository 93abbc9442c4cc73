// A robot behind a link: what the page says of it.

import { $, text } from "./dom.js";

/** @import { State } from "../types/page.js" */

/** @typedef {NonNullable<State["link"]>} Link */

/** @type {Record<string, string>} */
const PHASES = {
  holding: "waits for orders",
  halting: "comes to a stand",
  sitting: "sits down",
};
/** @type {Record<string, string>} */
const WHYS = {
  "asked to": "stopped",
  "line silent": "heard nothing of us",
  tilt: "it leans too far",
  "not finite": "a sensor failed",
  joints: "a joint is beyond its range",
  moving: "its legs are moved",
};

/**
 * What it does, in a few words.
 *
 * @param {Pick<Link, "phase" | "why" | "heard_s" | "silent">} link
 */
export function phaseOf({ phase, why, heard_s, silent }) {
  if (silent) return `silent for ${heard_s.toFixed(1)} s`;
  const says = PHASES[phase] ?? phase;
  return phase === "limp" && why ? `${says}: ${WHYS[why] ?? why}` : says;
}

/** How it is: whether it follows, is on its way to, or does not. @param {Link} link */
export const healthOf = ({ phase, silent }) =>
  silent || phase === "limp" ? "down" : phase === "following" ? "up" : "connecting";

/** @param {Link | null} link */
export function drawBehind(link) {
  const chip = $("#chip-robot");
  chip.hidden = !link;
  if (!link) return;
  chip.dataset.link = healthOf(link);
  text($("b", chip), `Robot: ${phaseOf(link)}`);
  const { name, level, heard_s, refused } = link;
  chip.title = `A robot behind a link, ${name}: ${level} are sent to it; heard ${Math.round(
    1000 * heard_s,
  )} ms ago; ${refused} datagrams not believed`;
}
