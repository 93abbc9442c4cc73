// The palette is loaded when it is first wanted.

import { $, $input, attempt } from "./dom.js";

/** @import { Entry, Palette } from "./palette.js" */

/** The palette, from when it is first opened on. */
export class PaletteDoor {
  /** @type {Palette | null} */
  #palette = null;

  /** @param {() => Entry[]} entries what can be done just now */
  constructor(entries) {
    this.entries = entries;
  }

  /** Not modal: the stop button must stay within reach. What is typed at once is kept, too, and
   * chosen when it is loaded. */
  open = () =>
    attempt(async () => {
      const [dialog, typed] = [$("#palette"), $input("#palette-typed")];
      typed.value = "";
      /** @type {HTMLDialogElement} */ (dialog).show();
      typed.focus();
      let chosen = false;
      const early = (/** @type {KeyboardEvent} */ { key }) => (chosen ||= key === "Enter");
      if (!this.#palette) typed.addEventListener("keydown", early);
      const { Palette } = await import("./palette.js");
      typed.removeEventListener("keydown", early);
      this.#palette ??= new Palette(this.entries);
      this.#palette.find();
      if (chosen) this.#palette.choose();
    });
}
