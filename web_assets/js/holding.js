// Who drives: this page, another one, or nobody.

import { $, $button, attempt, text, toast } from "./dom.js";

/** @import { State } from "../types/page.js" */
/** @import { Studio } from "./studio.js" */

/** Whether this page drives. @param {Studio} studio */
const driven = ({ api, state }) => state !== null && state.control.holder === api.page;

/** The buttons by which control changes hands. @param {Studio} studio @param {() => void} after */
export function startHolding(studio, after) {
  /** @type {Record<string, () => Promise<void>>} */
  const buttons = {
    "#control": () => takeOrGive(studio),
    "#watching-take": () => takeOrGive(studio),
    "#watching-ask": () => askOrAnswer(studio, "ask"),
    "#asked-over": () => askOrAnswer(studio, "hand_over"),
    "#asked-keep": () => askOrAnswer(studio, "keep"),
  };
  for (const [button, change] of Object.entries(buttons))
    $(button).addEventListener("click", () => attempt(() => change().then(after)));
}

/** Take control, or give it up. @param {Studio} studio */
async function takeOrGive(studio) {
  const { api } = studio;
  const mine = driven(studio);
  const action = mine ? "release" : "take";
  studio.state = await api.post("/api/control", { page: api.page ?? "", action });
  toast(mine ? "Control given up" : "You have control", "good");
}

/**
 * Ask whoever drives for control; or, driving, hand it to who asked first, or keep it.
 *
 * @param {Studio} studio
 * @param {"ask" | "hand_over" | "keep"} action
 */
async function askOrAnswer(studio, action) {
  const { api, state } = studio;
  const to = action === "hand_over" ? (state?.control.asking[0] ?? null) : null;
  studio.state = await api.post("/api/control", { page: api.page ?? "", action, to });
}

/** @param {Studio} studio @param {State} state */
export function drawControl(studio, state) {
  const mine = driven(studio);
  const { free, pages, asking } = state.control;
  const others = pages.length - 1;
  $("#control").dataset.held = mine ? "you" : free ? "none" : "other";
  const driving = others > 0 ? `You drive · ${others} watching` : "You drive";
  text($("#control"), mine ? driving : "Take control");
  document.body.dataset.role = mine ? "drive" : "watch";
  $("#watching").hidden = mine;
  const asked = asking.includes(studio.api.page ?? "");
  text($("#watching span"), watching(state.control));
  $("#watching-ask").hidden = free;
  $button("#watching-ask").disabled = asked;
  text($("#watching-ask"), asked ? "Asked" : "Ask");
  $("#asked").hidden = !mine || !asking.length;
  const more = asking.length > 1 ? `${asking.length} other pages ask` : "Another page asks";
  text($("#asked span"), `${more} to drive.`);
}

/** What a page is told that does not drive. @param {State["control"]} control */
export function watching({ holder, pages, free, away }) {
  const gone = holder && !pages.includes(holder) ? "The page that drove is closed" : "";
  const silent = holder ? "The page that drives does not answer" : "Nobody drives";
  const held = away ? "Another page drives, out of sight" : "Another page drives";
  return `You are watching. ${free ? gone || silent : held}; this page can only stop.`;
}
