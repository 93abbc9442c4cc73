// What the coach says, and how far it is.

import { capital, counted, spoken } from "./words.js";

/** @import { Collect } from "../types/page.js" */

/**
 * What the coach says: the task, which take it is, and what to do.
 *
 * @param {Pick<Collect, "phase" | "done" | "total" | "kept"> &
 *   Pick<Collect, "task" | "state" | "prompt">} collect
 */
export function coached({ phase, task, state, prompt, done, total, kept }) {
  if (phase === "done")
    return {
      task: `${counted(kept.length, "take")} kept`,
      of: "",
      prompt: "Review them below, or train a mapper of your own.",
    };
  const quiet = `${state === "sit" ? "Sit" : "Stand"} quietly until it moves.`;
  const waits = phase === "countdown" || phase === "ready";
  return {
    task: task ? capital(spoken(task)) : "",
    of: task ? `take ${Math.min(done + 1, total)} of ${total}` : "",
    prompt:
      phase === "setup"
        ? "Choose tasks on the right, then Begin."
        : waits
          ? `${prompt}. ${quiet}`
          : (prompt ?? ""),
  };
}

/**
 * How much of a phase has passed, from 0 to 1; null for one that waits for somebody.
 *
 * @param {Pick<Collect, "phase" | "t" | "remaining">} collect
 */
export function passed({ phase, t, remaining }) {
  const timed =
    ["preview", "record", "countdown"].includes(phase) ||
    (phase === "review" && remaining !== null);
  if (!timed) return null;
  const whole = t + (remaining ?? 0);
  return whole ? t / whole : 0;
}
