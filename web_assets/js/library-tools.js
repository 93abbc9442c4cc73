// What of the library is looked for: words, verdict, session and order.

import { $, $$, $input, $select, el, press } from "./dom.js";
import { exportMany } from "./exporting.js";
import { formatList } from "./formats.js";
import { listed, sessionsOf, takesOf } from "./library-list.js";

/** @import { CollectSession, Take } from "../types/page.js" */
/** @import { Api } from "./net.js" */

export class Tools {
  /** @type {Map<string, CollectSession>} */
  #sessions = new Map();
  #find = $input("#library-find");
  #session = $select("#library-session");
  #order = $select("#library-order");

  /** @param {Api} api @param {() => void} changed */
  constructor(api, changed) {
    this.#session.after(
      formatList("session-export", "Export session…", "Export the whole session", (format) =>
        exportMany(api, { session: this.#session.value, format }),
      ),
    );
    this.#find.addEventListener("input", changed);
    for (const list of [this.#order, this.#session]) list.addEventListener("change", changed);
    for (const button of $$("#library-verdict button"))
      button.addEventListener("click", () => {
        press($("#library-verdict"), "verdict", button.dataset.verdict ?? "");
        changed();
      });
  }

  /** Sessions to choose from. @param {CollectSession[]} sessions */
  offer(sessions) {
    this.#sessions = sessionsOf(sessions);
    const was = this.#session.value;
    const words = (/** @type {CollectSession} */ { operator, day, takes }) =>
      `${operator}, ${day} (${takesOf(takes.length)})`;
    this.#session.replaceChildren(
      el("option", { value: "" }, "Every session"),
      ...sessions.map((one) => el("option", { value: one.name }, words(one))),
    );
    this.#session.value = sessions.some(({ name }) => name === was) ? was : "";
  }

  /** Only what serves what is shown. @param {boolean} bin whether that is the bin */
  show(bin) {
    for (const tool of [this.#find, $("#library-verdict"), this.#order]) tool.hidden = bin;
    this.#session.hidden = bin || this.#session.options.length < 2;
    $("#session-export").hidden = bin || !this.#session.value;
  }

  /** Of the takes those that are looked for, in order. @param {Take[]} takes */
  of(takes) {
    const wanted = {
      words: this.#find.value,
      verdict: $("#library-verdict [aria-pressed=true]").dataset.verdict ?? "all",
      session: this.#session.value,
      order: this.#order.value,
    };
    return listed(takes, wanted, this.#sessions);
  }
}
