// The review's bench under the 3-D view: its bars, and the words on them.

import { $, $button, $input, $select, el, icon, press, setStyle, showIcon, text } from "./dom.js";
import { alignment, flaws } from "./findings.js";
import { formatList } from "./formats.js";

/** @import { Review, State, Take } from "../types/page.js" */

/** @type {[string, string][]} */
const FILM = [["film", "Video of the view"]];
const SPEEDS = [0.25, 0.5, 1, 2, 4];

/**
 * What the buttons of the bench do.
 *
 * @typedef {object} Actions
 * @property {() => void} close
 * @property {(label: string) => void} label
 * @property {(keep: boolean) => void} keep
 * @property {() => void} undo
 * @property {() => void} redo
 * @property {(format: string) => void} save
 * @property {() => void} split
 * @property {() => void} bin
 * @property {() => void} play
 * @property {(speed: number) => void} speed
 * @property {() => void} loop
 * @property {(which?: number[]) => void} clean
 * @property {(warp: boolean) => void} align
 * @property {() => void} leave
 * @property {() => void} compare
 */

/** The bench, hidden. @param {Actions} on */
export function benchOf(on) {
  const button = (
    /** @type {string} */ id,
    /** @type {string} */ words,
    /** @type {string} */ title,
    /** @type {() => void} */ onclick,
  ) => el("button", { id, title, onclick }, words);
  const picture = (
    /** @type {string} */ id,
    /** @type {string} */ name,
    /** @type {string} */ title,
    /** @type {() => void} */ onclick,
  ) => el("button", { id, title, "aria-label": title, onclick }, icon(name));
  const chosen = (/** @type {Event} */ event) => /** @type {HTMLSelectElement} */ (event.target);
  const verdict = (/** @type {boolean} */ keep, /** @type {string} */ words) =>
    el("button", { "data-keep": keep ? "true" : "false", onclick: () => on.keep(keep) }, words);
  const label = el("input", {
    type: "text",
    id: "bench-label",
    maxlength: 120,
    "aria-label": "Label of the take",
    onchange: () => on.label(label.value.trim()),
  });
  return el(
    "section",
    { class: "bench", id: "bench", hidden: true, "aria-label": "Review of a take" },
    el(
      "div",
      { class: "bench-bar" },
      el(
        "button",
        {
          class: "icon",
          id: "bench-close",
          title: "Close the review",
          "aria-label": "Close the review",
          onclick: on.close,
        },
        icon("close"),
      ),
      label,
      el(
        "div",
        {
          class: "segmented small",
          id: "bench-keep",
          role: "group",
          "aria-label": "Verdict",
        },
        verdict(true, "Keep"),
        verdict(false, "Reject"),
      ),
      el("em", { class: "score big", id: "bench-score", title: "Quality, from 0 to 100" }),
      el("span", { class: "note", id: "bench-why" }),
      el(
        "div",
        { class: "bench-right" },
        picture("bench-undo", "undo", "Take the last edit back (Z)", on.undo),
        picture("bench-redo", "redo", "Do it again (Y)", on.redo),
        formatList("bench-export", "Export", "Export the take", on.save, FILM),
        button("bench-split", "Split", "Two takes, cut here", on.split),
        button("bench-bin", "Bin", "Throw the take into the bin", on.bin),
      ),
    ),
    el(
      "div",
      { class: "bench-line" },
      el("canvas", {
        id: "timeline",
        role: "slider",
        tabindex: 0,
        "aria-label": "Time in the take, with you and what was shown drawn over it",
        "aria-valuemin": 0,
        "aria-valuemax": 0,
        "aria-valuenow": 0,
      }),
    ),
    el(
      "div",
      { class: "bench-bar" },
      picture("bench-play", "play", "Play or pause (P)", on.play),
      el(
        "select",
        {
          id: "bench-speed",
          "aria-label": "Speed",
          onchange: (/** @type {Event} */ event) => on.speed(+chosen(event).value),
        },
        ...SPEEDS.map((value) => el("option", { value, selected: value === 1 }, `× ${value}`)),
      ),
      picture("bench-loop", "loop", "Again and again (L)", on.loop),
      el("output", { id: "bench-time" }),
      el(
        "div",
        { class: "legend2" },
        el("i", { class: "h" }),
        "You",
        el("i", { class: "r" }),
        "Shown",
      ),
      el("div", { class: "align", id: "bench-align" }),
      el("div", { class: "found", id: "bench-found" }),
    ),
  );
}

/**
 * The take as it is edited now, and what was found in it.
 *
 * @param {Take} take
 * @param {Review} review
 * @param {boolean} aligned whether the person is shown as aligned
 * @param {Actions} on
 */
export function drawBench(take, review, aligned, on) {
  const label = $input("#bench-label");
  label.value = take.label;
  label.placeholder = take.name;
  press($("#bench-keep"), "keep", String(take.kept));
  const score = Math.round(review.quality.score);
  text($("#bench-score"), String(score));
  setStyle($("#bench-score"), { "--s": score });
  const reasons = review.quality.reasons.map((reason) => reason.message).join(" · ");
  text($("#bench-why"), reasons || "nothing to find fault with");
  $button("#bench-undo").disabled = !take.undoable;
  $button("#bench-redo").disabled = !take.redoable;
  $("#bench-align").replaceChildren(...alignment(take, review, aligned, on));
  $("#bench-found").replaceChildren(...flaws(review, on));
}

/** Ten times a second. @param {NonNullable<State["replay"]>} replay @param {number} seconds */
export function drawPlaying({ playing, loop, speed, t }, seconds) {
  showIcon($("#bench-play"), playing ? "pause" : "play");
  $("#bench-loop").setAttribute("aria-pressed", String(loop));
  const select = $select("#bench-speed");
  if (document.activeElement !== select) select.value = String(speed);
  text($("#bench-time"), `${t.toFixed(2)} / ${seconds.toFixed(2)} s`);
}
