// Which of some files are takes, zips of takes or motions: what is imported together.

/** @typedef {{ path: string, file: File }} Found a file, and where it lay */
/** @typedef {{ name: string, files: File[], single: boolean }} Job single: a file alone */

const PARTS = ["tape.mcap", "meta.json", "edits.jsonl"];
const SINGLE = /\.(zip|mcap|bvh|jsonl|json|ndjson)$/i;

/** @param {string} path */
const folderOf = (path) => path.slice(0, Math.max(0, path.lastIndexOf("/")));
/** @param {string} path */
export const baseOf = (path) => path.slice(path.lastIndexOf("/") + 1);

/**
 * A job a take, a zip or a motion; what lies about beside them is left alone.
 *
 * @param {Found[]} found
 * @returns {Job[]}
 */
export function jobsOf(found) {
  const isTape = (/** @type {Found} */ { path }) => baseOf(path) === "tape.mcap";
  const folders = [...new Set(found.filter(isTape).map(({ path }) => folderOf(path)))];
  const takes = folders.map((folder) => ({
    name: baseOf(folder) || "take",
    files: found
      .filter(({ path }) => folderOf(path) === folder && PARTS.includes(baseOf(path)))
      .map(({ file }) => file),
    single: false,
  }));
  const singles = found
    .filter(({ path }) => SINGLE.test(path) && !PARTS.includes(baseOf(path)))
    .map(({ path, file }) => ({ name: baseOf(path), files: [file], single: true }));
  return [...takes, ...singles];
}

/** Whether what is dropped can only be imported: folders, zips, several files. */
export const wantsImport = (/** @type {DataTransfer} */ { items, files }) =>
  [...items].some((item) => item.webkitGetAsEntry?.()?.isDirectory) ||
  [...files].some((file) => /\.(zip|mcap)$/i.test(file.name)) ||
  files.length > 1;

/**
 * What was dropped, folders and all. To be called while the event lasts.
 *
 * @param {DataTransfer} transfer
 * @returns {Promise<Found[]>}
 */
export async function gathered({ items, files }) {
  const entries = [...items].flatMap((item) => item.webkitGetAsEntry?.() ?? []);
  const plain = [...files].map((file) => ({ path: file.name, file }));
  if (!entries.length) return plain;
  try {
    return (await Promise.all(entries.map(walked))).flat();
  } catch {
    return plain;
  }
}

/** @param {FileSystemEntry} entry @returns {Promise<Found[]>} */
async function walked(entry) {
  if (entry.isFile) {
    const one = /** @type {FileSystemFileEntry} */ (entry);
    const file = await new Promise((done, fail) => one.file(done, fail));
    return [{ path: entry.fullPath.replace(/^\//, ""), file }];
  }
  const reader = /** @type {FileSystemDirectoryEntry} */ (entry).createReader();
  const inside = [];
  for (;;) {
    // A reader gives a hundred at a time.
    /** @type {FileSystemEntry[]} */
    const some = await new Promise((done, fail) => reader.readEntries(done, fail));
    if (!some.length) break;
    inside.push(...some);
  }
  return (await Promise.all(inside.map(walked))).flat();
}
