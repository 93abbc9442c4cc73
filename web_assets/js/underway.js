// What is under way: from "walk" meant to a robot that walks takes two seconds.

import { $, setStyle, text } from "./dom.js";

/** @import { Tick } from "../types/page.js" */

/** Of the whole way: the person begins, the studio is sure of it, the robot changes. */
const READ = 0.6;

/**
 * How far walking has come, from 0 to 1, and in words; null while nobody means it, or it walks.
 *
 * @param {Pick<Tick, "state" | "transition_to" | "votes" | "mode">} tick
 * @param {boolean} meant whether a key means walking
 */
export function underWay({ state, transition_to, votes, mode }, meant) {
  if (mode !== "live" || state === "walk") return null;
  if (transition_to === "walk") return { share: READ, words: "It changes to walking" };
  const sure = votes.walk ?? 0;
  if (!meant) return null;
  return {
    share: READ * sure,
    words: sure ? "Marching: it is being read" : "Walking begins: the person starts to march",
  };
}

/** @param {Tick} tick @param {boolean} meant */
export function drawUnderWay(tick, meant) {
  const now = underWay(tick, meant);
  const pill = $("#underway");
  pill.hidden = now === null;
  if (!now) return;
  text($("span", pill), now.words);
  setStyle($("i", pill), { "--v": now.share.toFixed(2) });
}
