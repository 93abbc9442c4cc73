// The joint map: which of a source's joints is which of a person's.

import { $, attempt, el, text, toast } from "./dom.js";
import { capital, jointName } from "./words.js";

/** @import { Studio } from "./studio.js" */

const NONE = "\u0000none"; // no file can call a joint so

export class Joints {
  #dialog = /** @type {HTMLDialogElement} */ ($("#joints"));
  #source = "";

  /** @param {Studio} studio */
  constructor(studio) {
    this.studio = studio;
    $("#joints-save").addEventListener("click", () => attempt(() => this.#save(this.#said())));
    $("#joints-forget").addEventListener("click", () => attempt(() => this.#save({})));
    $("#joints-close").addEventListener("click", () => this.#dialog.close());
  }

  /**
   * The dialog, for the source in use or one that could not be read without. Not modal: the stop
   * button must stay within reach.
   *
   * @param {string} [source]
   */
  async show(source) {
    const found = await this.studio.api.get("/api/joint-map", source ? { source } : {});
    this.#source = found.source;
    this.#complain("");
    // Those first that a person has to say.
    const names = found.missing.concat(Object.keys(found.found));
    const rows = names.map((joint) => {
      const own = (found.found[joint] ?? []).join(" + ");
      const said = found.map[joint];
      const guess = joint in found.map ? "found by its name" : own || "not found";
      const select = el(
        "select",
        { "data-joint": joint, "aria-label": jointName(joint) },
        el("option", { value: "" }, guess),
        el("option", { value: NONE }, "none of them"),
        ...found.joints.map((name) => el("option", { value: name }, name)),
      );
      if (said && said.length > 1)
        select.append(el("option", { value: JSON.stringify(said) }, said.join(" + ")));
      if (said) select.value = said.length > 1 ? JSON.stringify(said) : (said[0] ?? NONE);
      const needed = found.needed.includes(joint);
      const lacks = needed && !own;
      return el(
        "label",
        { class: `field ${lacks ? "lacks" : ""}` },
        el("span", {}, `${capital(jointName(joint))}${needed ? " *" : ""}`),
        select,
      );
    });
    $("#joints-rows").replaceChildren(...rows);
    $("#joints-forget").hidden = Object.keys(found.map).length === 0;
    if (!this.#dialog.open) this.#dialog.show();
    $("#joints-rows select").focus();
  }

  /** What was chosen by hand: canonical joint to the file's, a list of them, or null for none. */
  #said() {
    /** @type {Record<string, string | string[] | null>} */
    const said = {};
    for (const select of this.#dialog.querySelectorAll("select")) {
      if (!select.value || !select.dataset.joint) continue;
      if (select.value === NONE) said[select.dataset.joint] = null;
      else if (select.value.startsWith("[")) said[select.dataset.joint] = JSON.parse(select.value);
      else said[select.dataset.joint] = select.value;
    }
    return said;
  }

  /** @param {Record<string, string | string[] | null>} map */
  async #save(map) {
    try {
      await this.studio.api.post("/api/joint-map", { map, source: this.#source });
    } catch (error) {
      this.#complain(error instanceof Error ? capital(error.message) : String(error));
      return;
    }
    this.#dialog.close();
    toast("Kept for every file with the same joints; it drives the robot now", "good");
  }

  /** @param {string} why "" for nothing */
  #complain(why) {
    text($("#joints-error"), why);
    $("#joints-error").hidden = !why;
  }
}
