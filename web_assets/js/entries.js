// What the palette lists: what the page's own buttons and lists do, by their names.

import { $$, $select } from "./dom.js";

/** @import { Entry } from "./palette.js" */

/** Buttons by selector, what goes before their names, and keys where they have some. */
const BUTTONS = /** @type {const} */ ([
  ["#mode button", "Mode: "],
  ["#lock button", "State: "],
  ["#style button", "Walking means: "],
  [".cameras button", "Camera: ", ["1", "2", "3", "4", "5", "6"]],
  ["#figures button", "Show, ghost or hide: "],
  ["#besides button", "Show besides: "],
  ["#record", "", ["H"]],
  ["#push", "Tool: ", ["7"]],
  ["#place", "Tool: ", []],
  ["#keys-drive", ""],
  ["#sample", ""],
  ["#vmc", ""],
  ["#calibrate", ""],
  ["#control", ""],
  ["#guide-again", ""],
]);
const LISTS = /** @type {const} */ ([
  ["#task", "Synthetic person: "],
  ["#controller", "Controller: "],
  ["#scene-name", "Scene: "],
]);

/** A button's name without its key's. @param {HTMLElement} button */
const nameOf = (button) =>
  [...button.childNodes]
    .filter((node) => !(node instanceof Element && node.matches("kbd, span")))
    .map((node) => node.textContent?.trim())
    .filter(Boolean)
    .join(" ");

/** All that can be pressed or chosen just now. @returns {Entry[]} */
export function pageEntries() {
  const buttons = BUTTONS.flatMap(([selector, before, keys]) =>
    /** @type {HTMLButtonElement[]} */ ($$(selector))
      .filter((button) => !button.disabled)
      .map((button, i) => ({
        words: before + nameOf(button),
        key: keys?.[i],
        run: () => button.click(),
      })),
  );
  const choices = LISTS.flatMap(([selector, before]) => {
    const list = $select(selector);
    return [...list.options]
      .filter((option) => !option.disabled && option.value)
      .map((option) => ({
        words: before + option.textContent,
        run: () => {
          list.value = option.value;
          list.dispatchEvent(new Event("change"));
        },
      }));
  });
  return [...buttons, ...choices];
}
