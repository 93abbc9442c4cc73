// The form of a training: what to learn from, which states and style, where learning starts.

import { el } from "./dom.js";
import { capital } from "./words.js";

const STATES = ["stand", "walk", "sit"];
const STYLES = ["march", "circles", "semantic"];
const STEPS = "Steps of learning; empty: by the amount of data";

/** The choice to learn from takes rather than from a data set. */
export const ticked = () => el("option", { value: "" }, "The takes ticked above");

/** The form, below the takes that are ticked. */
export function form() {
  const option = ([value, words] = ["", ""]) => el("option", { value }, words);
  const field = { type: "text", maxlength: 60, placeholder: "Name (optional)" };
  return [
    el("p", { class: "note", id: "train-takes" }),
    el("select", { id: "train-from", "aria-label": "Learn from" }, ticked()),
    el(
      "div",
      { class: "row states", role: "group", "aria-label": "States to train" },
      ...STATES.map((state) =>
        el(
          "label",
          { class: "tick" },
          el("input", { type: "checkbox", value: state, checked: true }),
          capital(state),
        ),
      ),
    ),
    el(
      "div",
      { class: "row" },
      el("input", { ...field, id: "train-name", "aria-label": "Name of the mapper" }),
      el(
        "select",
        { id: "train-style", "aria-label": "What walking looks like" },
        ...STYLES.map((style) => option([style, capital(style)])),
      ),
    ),
    el(
      "div",
      { class: "row" },
      el(
        "select",
        {
          id: "train-start",
          "aria-label": "Where learning starts",
          title: "Little data learns best from where the shipped mapper is",
        },
        option(["shipped", "From shipped"]),
        option(["scratch", "From scratch"]),
      ),
      el("input", {
        type: "number",
        id: "train-steps",
        min: 20,
        max: 100000,
        placeholder: "Steps",
        "aria-label": STEPS,
        title: STEPS,
      }),
    ),
    el(
      "div",
      { class: "row" },
      // Until it is known which takes there are: it would be refused.
      el("button", { class: "main", id: "train-go", disabled: true }, "Train"),
      el("button", { id: "train-cancel", hidden: true }, "Cancel"),
    ),
    // Below the button, which must not move from under a finger when it comes.
    el("ul", { class: "note", id: "train-pairs", "aria-label": "What there is to learn from" }),
    el("p", { class: "note", id: "train-says", role: "status" }),
    el("canvas", {
      class: "loss",
      id: "loss",
      height: 110,
      hidden: true,
      role: "img",
      "aria-label": "Loss while training",
    }),
    el("div", { id: "train-scores" }),
  ];
}
