// A take as a card of the library: its picture, what it is called, how good it is.

import { attempt, el } from "./dom.js";
import { length, moment, space, verdictOf } from "./library-list.js";
import { spoken } from "./words.js";

/** @import { Binned, Take } from "../types/page.js" */
/** @import { Pictures } from "./pictures.js" */

/**
 * What a card's buttons do.
 *
 * @typedef {object} CardActions
 * @property {(id: string, event: MouseEvent) => void} choose
 * @property {(name: string) => unknown} review
 * @property {(name: string) => unknown} replay
 * @property {(name: string) => unknown} drive
 * @property {(place: string) => unknown} restore
 */

const SAID = { kept: "kept", new: "", rejected: "rejected" };

/**
 * @param {Take} take
 * @param {boolean} chosen
 * @param {Pictures} pictures
 * @param {CardActions} on
 */
export function takeCard(take, chosen, pictures, on) {
  const { name, label, score, started, damaged, recording } = take;
  const image = picture();
  if (!recording) pictures.show(image, take);
  const verdict = verdictOf(take);
  const said = recording
    ? ["being recorded"]
    : [`${length(take).toFixed(1)} s`, damaged ? "damaged" : SAID[verdict], moment(started)];
  const button = (
    /** @type {string} */ words,
    /** @type {string} */ title,
    /** @type {(name: string) => unknown} */ what,
  ) => small(words, name, title, () => what(name));
  const percent = Math.round(100 * (score ?? 0));
  return el(
    "li",
    { class: `${verdict} ${chosen ? "chosen" : ""}`, "data-id": name, title: damaged || name },
    box(name, name, chosen, recording, on),
    el(
      "button",
      {
        class: "picture",
        "aria-label": `Review ${name}`,
        title: "Scrub, trim, align, judge",
        disabled: recording,
        onclick: () => attempt(() => on.review(name)),
      },
      image,
    ),
    score == null
      ? null
      : el(
          "em",
          { class: "score", style: { "--s": percent }, title: "Quality, from 0 to 100" },
          String(percent),
        ),
    words(label || name, said),
    recording
      ? null
      : el(
          "div",
          { class: "row" },
          button("Replay", "Show the take again as it was", on.replay),
          button("Drive", "Let the recorded person drive the robot again", on.drive),
        ),
  );
}

/**
 * @param {Binned} binned
 * @param {boolean} chosen
 * @param {Pictures} pictures
 * @param {CardActions} on
 */
export function binCard({ place, deleted, bytes, take }, chosen, pictures, on) {
  const { name, label } = take;
  const image = picture();
  pictures.show(image, { ...take, name: place });
  const title = `${name}, deleted ${moment(deleted)}`;
  return el(
    "li",
    { class: `binned ${chosen ? "chosen" : ""}`, "data-id": place, title },
    box(place, name, chosen, false, on),
    el("div", { class: "picture" }, image),
    words(label || name, [`${take.seconds.toFixed(1)} s`, space(bytes), moment(deleted)]),
    el(
      "div",
      { class: "row" },
      small("Restore", name, "Back among the takes", () => on.restore(place)),
    ),
  );
}

/** @param {string} words @param {string} name @param {string} title @param {() => unknown} what */
const small = (words, name, title, what) =>
  el("button", { title, "aria-label": `${words} ${name}`, onclick: () => attempt(what) }, words);

const picture = () => el("img", { alt: "", width: 200, height: 100 });

/**
 * @param {string} id
 * @param {string} name
 * @param {boolean} chosen
 * @param {boolean} disabled
 * @param {CardActions} on
 */
const box = (id, name, chosen, disabled, on) =>
  el("input", {
    type: "checkbox",
    "data-arrows": "",
    "aria-label": `Select ${name}`,
    checked: chosen,
    disabled,
    onclick: (/** @type {MouseEvent} */ event) => on.choose(id, event),
  });

/** @param {string} name @param {string[]} said */
const words = (name, said) =>
  el(
    "div",
    { class: "name" },
    el("b", {}, spoken(name)),
    el("span", {}, said.filter(Boolean).join(" · ")),
  );
