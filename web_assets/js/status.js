// The line that says what the studio does, or why nothing moves, and the buttons that stop it.

import { $, $button, text } from "./dom.js";
import { capital, stoppedBy } from "./words.js";

/** @import { State } from "../types/page.js" */

/** @type {Record<State["style"], string>} */
const WALKING = {
  march: "walking as you march",
  circles: "walking as you circle your hands",
  semantic: "walking at the speed your steps say",
};

/** @type {Record<string, string>} */
const STOPS = {
  stopped: "Emergency stop",
  fallen: "The robot fell",
  fault: "Stopped by a fault",
};

/**
 * What the studio does, or why nothing moves.
 *
 * @param {Pick<State, "why" | "mode" | "state" | "style">} state
 */
export function doing({ why, mode, state, style }) {
  if (why) return capital(why);
  if (mode === "collect") return "Collecting: the robot shows what to act out";
  if (mode === "replay") return "Replaying a take, as it was";
  /** @type {Record<string, string>} */
  const words = {
    stand: "standing with you",
    walk: WALKING[style],
    sit: "sitting with you",
    transition: "changing its stance",
  };
  return `Following: ${words[state] ?? state}`;
}

/**
 * Why the robot is stopped, and what to do about it.
 *
 * @param {Pick<State, "reason" | "needs_reset">} state
 */
export function stopped({ reason, needs_reset }) {
  return {
    title: STOPS[reason] ?? "Stopped",
    next: needs_reset
      ? "Its joints are damped. Press Reset to stand up, then Arm."
      : "It is up again. Press Arm to follow.",
  };
}

/** @param {State} state @param {string | null} page this one's name */
export function drawStatus(state, page) {
  const { armed, needs_reset, reason, stale_s } = state;
  const words = stopped(state);
  $("#stopped").hidden = !state.stopped;
  text($("#stopped b"), words.title);
  text($("#stopped span"), words.next);
  $(".stage").classList.toggle("is-stopped", state.stopped);
  $("#reset").classList.toggle("next", state.stopped && needs_reset);
  $("#arm").classList.toggle("next", !armed && !(state.stopped && needs_reset));
  $button("#arm").disabled = armed && !state.stopped;
  const status = $("#status");
  status.dataset.kind = state.stopped ? "stopped" : reason ? "wait" : "moving";
  status.dataset.reason = reason;
  status.title =
    stale_s === null ? "Nobody was seen yet" : `Last human pose ${stale_s.toFixed(1)} s ago`;
  const why = stoppedBy(state.why, page, state.control.pages);
  text($("#status span"), doing({ ...state, why }));
}

/**
 * Whether the studio is there.
 *
 * @param {"connecting" | "up" | "down" | "locked"} link
 * @param {boolean} late whether no tick has come for a while
 */
export function drawLink(link, late) {
  const shown = link === "up" && late ? "connecting" : link;
  $("#chip-link").dataset.link = shown;
  const words = {
    up: "Connected",
    connecting: late ? "No ticks" : "Connecting",
    down: "Disconnected",
    locked: "Signed out",
  };
  text($("#chip-link b"), words[shown]);
  if (link !== "down") return;
  $("#status").dataset.kind = "stopped";
  text(
    $("#status span"),
    "The studio does not answer; trying again. Is a1-studio serve still running?",
  );
}
