// An export of many takes: begun, watched, cancelled, downloaded.

import { $, attempt, el, setStyle, text, toast } from "./dom.js";
import { became, space } from "./library-list.js";
import { capital } from "./words.js";

/** @import { Body, Export } from "../types/page.js" */
/** @import { Api } from "./net.js" */

const OFTEN = 300; // ms between two looks

/**
 * Export takes or a session, and download the file once it is made.
 *
 * @param {Api} api
 * @param {Body<"/api/exports", "post">} body
 */
export const exportMany = (api, body) =>
  attempt(async () => {
    const started = await api.post("/api/exports", body);
    const shown = new Progress(api, started);
    try {
      ended(await shown.followed());
    } finally {
      shown.node.remove();
    }
  });

/** How far it is, among the words at the top. */
class Progress {
  bar = el("i");

  /** @param {Api} api @param {Export} started */
  constructor(api, started) {
    this.api = api;
    this.now = started;
    const cancel = () => attempt(() => api.post("/api/exports/cancel"));
    this.words = el("span", {}, `Exporting ${started.total} takes`);
    this.node = el(
      "div",
      { class: "toast good exporting" },
      this.words,
      el("button", { onclick: cancel }, "Cancel"),
      el("div", { class: "meter", "aria-hidden": "true" }, this.bar),
    );
    $("#toasts").append(this.node);
  }

  /** Until it has ended. */
  async followed() {
    const { id } = this.now;
    while (this.now.status === "running") {
      setStyle(this.bar, { transform: `scaleX(${this.now.done / this.now.total})` });
      await new Promise((done) => setTimeout(done, OFTEN));
      const next = await this.api.get("/api/exports");
      if (next?.id !== id) throw new Error("another page exports now");
      this.now = next;
    }
    return this.now;
  }
}

/** @param {Export} made */
function ended({ id, status, total, left_out, file, bytes, why }) {
  if (status === "cancelled") toast("The export was cancelled", "good");
  else if (status === "failed") toast(capital(why));
  else {
    el("a", { href: `/api/exports/${id}/file`, download: "" }).click();
    const done = Array(total - Object.keys(left_out).length).fill("");
    const words = became(`in ${file} (${space(bytes)})`, done, left_out);
    text(toast("", Object.keys(left_out).length ? "" : "good"), words);
  }
}
