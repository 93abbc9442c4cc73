// Into the bin, with a way back.

import { attempt, el, takesChanged, toast } from "./dom.js";

/** @import { Api } from "./net.js" */

/**
 * Throw a take away, and offer to bring it back.
 *
 * @param {Api} api
 * @param {string} name
 * @param {() => unknown} [restored] what else to do once it is back
 */
export async function throwAway(api, name, restored = () => {}) {
  await api.delete("/api/takes/{name}", { name });
  takesChanged();
  const restore = async () => {
    said.remove();
    await api.post("/api/takes/{name}/restore", undefined, { name });
    takesChanged();
    restored();
  };
  const back = el("button", { class: "undo", onclick: () => attempt(restore) }, "Undo");
  const said = toast(`${name} is in the bin`, "good", " ", back);
}
