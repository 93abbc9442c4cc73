// Formats that takes are exported in, and what they are called.

import { el } from "./dom.js";

const FORMATS = [
  ["html", "Replay as a web page"],
  ["takes", "As it is, to import again"],
  ["lerobot", "LeRobot data set"],
  ["hdf5", "HDF5 (robomimic)"],
  ["mcap", "MCAP (Foxglove, rerun)"],
  ["npz", "NPZ: both sides"],
  ["csv", "CSV: both sides"],
  ["bvh", "BVH: the person"],
  ["jsonl", "JSON lines: the person"],
  ["pairs", "Pairs as Parquet"],
];

/**
 * A list that exports in the format that is chosen of it.
 *
 * @param {string} id
 * @param {string} title
 * @param {string} name what is exported, for who hears the page
 * @param {(format: string) => unknown} save
 * @param {[string, string][]} [more] what there is beside them
 */
export function formatList(id, title, name, save, more = []) {
  const list = el(
    "select",
    {
      id,
      "aria-label": name,
      onchange: () => {
        const format = list.value;
        list.value = "";
        save(format);
      },
    },
    el("option", { value: "" }, title),
    ...[...more, ...FORMATS].map(([value, words]) => el("option", { value }, words)),
  );
  return list;
}
