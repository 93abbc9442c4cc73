// Who drives: this page, another one, or nobody.

import { $, text, toast } from "./dom.js";

/** @import { State } from "../types/page.js" */
/** @import { Studio } from "./studio.js" */

/** Whether this page drives. @param {Studio} studio */
const driven = ({ api, state }) => state !== null && state.control.holder === api.page;

/** Take control, or give it up. @param {Studio} studio */
export async function takeOrGive(studio) {
  const { api } = studio;
  const mine = driven(studio);
  const action = mine ? "release" : "take";
  studio.state = await api.post("/api/control", { page: api.page ?? "", action });
  toast(mine ? "Control given up" : "You have control", "good");
}

/** @param {Studio} studio @param {State} state */
export function drawControl(studio, state) {
  const mine = driven(studio);
  const { free, pages } = state.control;
  const others = pages.length - 1;
  $("#control").dataset.held = mine ? "you" : free ? "none" : "other";
  const driving = others > 0 ? `You drive · ${others} watching` : "You drive";
  text($("#control"), mine ? driving : "Take control");
  document.body.dataset.role = mine ? "drive" : "watch";
  $("#watching").hidden = mine;
  text($("#watching span"), watching(state.control));
}

/** What a page is told that does not drive. @param {State["control"]} control */
export function watching({ holder, pages, free, away }) {
  const gone = holder && !pages.includes(holder) ? "The page that drove is closed" : "";
  const silent = holder ? "The page that drives does not answer" : "Nobody drives";
  const held = away ? "Another page drives, out of sight" : "Another page drives";
  return `You are watching. ${free ? gone || silent : held}; this page can only stop.`;
}
