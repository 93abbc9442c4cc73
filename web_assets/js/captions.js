// The names of the three figures, and what each does: a pure function, without a page.

import { phaseOf } from "./behind.js";
import { spoken } from "./words.js";

/** @import { State, Tick } from "../types/page.js" */

/** Nobody real, somebody recorded, or you. @param {string} source */
function person(source) {
  if (source.startsWith("operator")) return "Synthetic person";
  return /^(bvh|frames|take):/.test(source) ? "Recorded person" : "You";
}

/**
 * What is over each figure: its name, and a line below.
 *
 * @param {Pick<Tick, "mode" | "state" | "transition_to" | "controller" | "expert" | "fallen"> &
 *   { human: unknown }} tick
 * @param {Partial<Pick<State, "source" | "transport" | "link">> | null} studio its state
 * @returns {Record<"human" | "reference" | "robot", [string, string]>}
 */
export function captionsOf(tick, studio) {
  const { source = "operator", transport, link } = studio ?? {};
  const { mode, state, transition_to, controller, human, expert, fallen } = tick;
  const shown = mode === "replay" && controller === "recorded";
  const should = shown ? "What it was shown" : "What it should do";
  const take = source.startsWith("take:");
  // A take on the review's bench is not what the transport plays.
  const over = transport?.ended && (take || mode !== "replay");
  const ended = over ? `the ${take ? "take" : "clip"} has ended` : "";
  const meaning = expert === "unknown" ? "motion not known" : `meaning: ${expert}`;
  return {
    human: [
      person(mode === "replay" ? "take:" : source),
      ended || (human ? meaning : "nobody seen"),
    ],
    reference: [
      mode === "collect" ? "What to act out" : should,
      state === "transition" ? `changing to ${transition_to ?? "…"}` : state,
    ],
    robot:
      link && mode !== "replay"
        ? ["Robot behind a link", phaseOf(link)]
        : ["What physics lets it do", fallen ? "fallen" : spoken(controller)],
  };
}
