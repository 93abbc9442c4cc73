// What is done to the takes that are chosen, each answered with what became of it and a way back.

import { attempt, el, takesChanged, toast } from "./dom.js";
import { exportMany } from "./exporting.js";
import { formatList } from "./formats.js";
import { became, takesOf } from "./library-list.js";

/** @import { Take } from "../types/page.js" */
/** @import { Api } from "./net.js" */

/** @typedef {"keep" | "reject" | "undecided"} Verdict */

const DONE = { keep: "kept", reject: "rejected", undecided: "undecided", delete: "in the bin" };
/** By what a take was. */
const BACK = /** @type {const} */ ({ true: "keep", false: "reject", null: "undecided" });

/** Give takes a verdict; undo gives each the one it had. */
/** @param {Api} api @param {Take[]} takes @param {Verdict} action */
export const judge = (api, takes, action) =>
  attempt(async () => {
    const names = takes.map(({ name }) => name);
    const { done, refused } = await api.post("/api/takes/many", { names, action });
    takesChanged();
    const changed = takes.filter(({ name }) => done.includes(name));
    withUndo(became(DONE[action], done, refused), done.length > 0, async () => {
      for (const [was, verdict] of Object.entries(BACK)) {
        const names = changed.filter((t) => String(t.kept ?? null) === was).map((t) => t.name);
        if (names.length) await api.post("/api/takes/many", { names, action: verdict });
      }
    });
  });

/** Into the bin; undo brings them back. @param {Api} api @param {string[]} names */
export const binned = (api, names) =>
  attempt(async () => {
    const { done, refused, binned } = await api.post("/api/takes/many", {
      names,
      action: "delete",
    });
    takesChanged();
    withUndo(became(DONE.delete, done, refused), done.length > 0, async () => {
      const back = await api.post("/api/bin", { places: binned, action: "restore" });
      if (Object.keys(back.refused).length)
        toast(became("came back", back.done, byTake(back.refused)));
    });
  });

/** Out of the bin. @param {Api} api @param {string[]} places */
export const restored = (api, places) =>
  attempt(async () => {
    const { done, refused } = await api.post("/api/bin", { places, action: "restore" });
    takesChanged();
    toast(became("restored", done, byTake(refused)), Object.keys(refused).length ? "" : "good");
  });

/** Never to come back: whoever calls has asked. @param {Api} api @param {string[]} places */
export const deletedForGood = (api, places) =>
  attempt(async () => {
    const { done, refused } = await api.post("/api/bin", { places, action: "delete" });
    takesChanged();
    toast(became("deleted for good", done, byTake(refused)), "good");
  });

/** By the takes' names: a place in the bin is one with when it was deleted. */
/** @param {Record<string, string>} refused */
const byTake = (refused) =>
  Object.fromEntries(Object.entries(refused).map(([place, why]) => [place.split(".")[0], why]));

/** @param {string} words @param {boolean} can @param {() => Promise<unknown>} undo */
function withUndo(words, can, undo) {
  const back = async () => {
    said.remove();
    await undo();
    takesChanged();
  };
  const button = el("button", { class: "undo", onclick: () => attempt(back) }, "Undo");
  const said = toast(words, "good", ...(can ? [" ", button] : []));
}

/**
 * The bar under the list, while takes are chosen.
 *
 * @param {Api} api
 * @param {() => Take[]} chosen
 * @param {(names: string[]) => unknown} train
 */
export function takeActions(api, chosen, train) {
  const names = () => chosen().map(({ name }) => name);
  const button = (
    /** @type {string} */ id,
    /** @type {string} */ words,
    /** @type {string} */ title,
    /** @type {() => unknown} */ onclick,
  ) => el("button", { id, title, onclick }, words);
  return [
    button("many-keep", "Keep", "They are learnt from", () => judge(api, chosen(), "keep")),
    button("many-reject", "Reject", "They stay, and are not learnt from", () =>
      judge(api, chosen(), "reject"),
    ),
    button("many-bin", "Bin", "Into the bin (Delete)", () => binned(api, names())),
    formatList("many-export", "Export as…", "Export the selected takes", (format) =>
      exportMany(api, { takes: names(), format }),
    ),
    button("many-train", "Train on these", "Open training with exactly these ticked", () =>
      attempt(() => train(names())),
    ),
  ];
}

/**
 * The same in the bin. Deleting for good asks once, in place.
 *
 * @param {Api} api
 * @param {() => string[]} chosen places
 */
export function binActions(api, chosen) {
  const restore = el("button", { id: "bin-restore", onclick: () => restored(api, chosen()) });
  restore.append("Restore");
  const ask = el("button", { id: "bin-delete", class: "danger" }, "Delete for good…");
  const sure = el("button", { id: "bin-sure", class: "danger sure", hidden: true });
  const no = el("button", { id: "bin-no", hidden: true }, "No");
  const asking = (/** @type {boolean} */ on) => {
    ask.hidden = on;
    sure.hidden = no.hidden = !on;
  };
  ask.addEventListener("click", () => {
    sure.textContent = `Yes, delete ${takesOf(chosen().length)} for good`;
    asking(true);
    no.focus();
  });
  no.addEventListener("click", () => {
    asking(false);
    ask.focus();
  });
  sure.addEventListener("click", () => {
    asking(false);
    deletedForGood(api, chosen());
  });
  const show = (/** @type {boolean} */ on) => {
    restore.hidden = ask.hidden = !on;
    sure.hidden = no.hidden = true;
  };
  return { nodes: [restore, ask, sure, no], show };
}
