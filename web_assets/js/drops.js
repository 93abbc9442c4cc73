// Files dropped anywhere on the page, its framed view included.

import { $, text } from "./dom.js";
import { gathered, wantsImport } from "./files.js";

/** @import { Found } from "./files.js" */
/** @import { SourcePanel } from "./source.js" */

const KINDS = /** @type {const} */ (["dragenter", "dragover", "dragleave", "drop"]);

export class Drops {
  /** How many nested elements the file is over. */
  #depth = 0;

  /** @param {SourcePanel} source @param {(files: Found[]) => unknown} keep them as takes */
  constructor(source, keep) {
    this.source = source;
    this.keep = keep;
    for (const kind of KINDS) window.addEventListener(kind, this.drag);
  }

  /** For any window's drag events. @param {DragEvent} event */
  drag = (event) => {
    event.preventDefault();
    if (event.type === "dragenter") this.#depth += 1;
    if (event.type === "dragleave") this.#depth = Math.max(0, this.#depth - 1);
    if (event.type === "drop") {
      this.#depth = 0;
      if (event.dataTransfer) this.#take(event.dataTransfer);
    }
    $("#drop").hidden = this.#depth === 0;
    text(
      $("#drop span"),
      this.#kept
        ? "takes in folders or a zip, a .bvh or .jsonl motion: they become takes"
        : "a .bvh or .jsonl motion file plays at once; takes are imported",
    );
  };

  /** Collecting, a motion is to be kept; live, it is to move the robot at once. */
  get #kept() {
    return document.body.dataset.work === "collect";
  }

  /** @param {DataTransfer} transfer */
  #take(transfer) {
    if (this.#kept || wantsImport(transfer)) gathered(transfer).then(this.keep);
    else if (transfer.files[0]) this.source.open(transfer.files[0]);
  }
}
