// Words for what the studio names: pure functions, without a page.

/** @import { Rival, State, Take } from "../types/page.js" */

/** @param {string} words */
export const capital = (words) => (words ? words[0].toUpperCase() + words.slice(1) : words);

/** A name with underscores as people write it. @param {string} name */
export const spoken = (name) => name.replaceAll("_", " ");

/** A joint as people call it: "l_knee" is the left knee. @param {string} name */
export const jointName = (name) => spoken(name.replace(/^l_/, "left_").replace(/^r_/, "right_"));

/** @param {number} count @param {string} noun */
export const counted = (count, noun) => `${count} ${noun}${count === 1 ? "" : "s"}`;

/** "(A) Kim et al. 2020", or what it does. @param {Rival} rival */
export const rivalName = ({ letter, name, title }) => {
  const who = title.includes(": ") ? title.split(": ")[0] : spoken(name);
  return letter ? `(${letter}) ${who}` : capital(who);
};

/**
 * What a rival does, by whom, and what it cannot.
 *
 * @param {Rival} rival
 * @param {string[]} refused states in which the shipped experts map in its place
 */
export function rivalLine({ title, given, source, limits }, refused = []) {
  const does = capital(title.split(": ").at(-1) ?? title);
  const paper = /^.*?\b(?:19|20)\d\d\b/.exec(source)?.[0];
  const parts = [`${does}; fitted to ${given}.`];
  if (paper) parts.push(`Source: ${paper}.`);
  if (limits) parts.push(`Limits: ${limits}`);
  if (refused.length) parts.push(`Here it does not map ${refused.join(" and ")}: shipped does.`);
  return parts.join(" ");
}

/**
 * "by page-1a2b3c" is, to a person, "by this page" or "by another page".
 *
 * @param {string} why
 * @param {string | null} page this one's name
 * @param {string[]} [open] those that are open
 */
export const stoppedBy = (why, page, open) =>
  why.replace(/\bpage-[0-9a-f]{6}\b/g, (name) =>
    name === page ? "this page" : !open || open.includes(name) ? "another page" : "a closed page",
  );

/** "bvh:/tmp/…/1a2b3c4d_march.bvh" is, to a person, "march.bvh". @param {string} spec */
export const sourceName = (spec) =>
  spec
    .replace(/^(bvh|frames):.*[\\/]([0-9a-f]{8}_)?/, "")
    .replace(/^operator:interactive$/, "keyboard")
    .replace(/^vmc(?=$|:)/, "VMC app")
    .replace(/^(operator|take):/, "$1 · ");

/**
 * What was read of a source, in a line, and how its frames come where they do so live.
 *
 * @param {State["source_report"]} report
 * @param {State["arrivals"]} [arrivals]
 */
export function reportLine(
  { joints_found, joints_missing, scale_m, up_axis, refused },
  arrivals = null,
) {
  const found = Object.keys(joints_found).length;
  const parts = [`${found} of ${found + joints_missing.length} joints`];
  if (scale_m) parts.push(`1 unit = ${Number(scale_m.toPrecision(3))} m`);
  if (up_axis) parts.push(`up ${up_axis}`);
  if (arrivals) {
    const ms = (/** @type {number | undefined} */ v) => `${(v ?? 0).toFixed(0)} ms`;
    parts.push(`${arrivals.rate_hz.toFixed(0)} frames a second`);
    parts.push(`jitter ${ms(arrivals.jitter_ms)}`, `up to ${ms(arrivals.late_ms.p95)} late`);
    parts.push(`read after ${ms(arrivals.wait_ms.p50)}`);
  }
  if (refused.frames) parts.push(`${counted(refused.frames, "frame")} refused`);
  return parts.join(" · ");
}

/**
 * The newest takes in which every typed word occurs, at most `most`, and a line on how many.
 *
 * @template {Pick<Take, "name" | "label" | "note" | "source">} T
 * @param {T[]} takes from the oldest to the newest
 * @param {string} words
 * @param {number} most
 * @returns {{ rows: T[], line: string }}
 */
export function search(takes, words, most) {
  const plain = (/** @type {string} */ said) => spoken(said.toLowerCase());
  const wanted = plain(words).split(/\s+/).filter(Boolean);
  const found = takes.filter((take) => {
    const said = plain([take.name, take.label, take.note, take.source].join(" "));
    return wanted.every((word) => said.includes(word));
  });
  const rows = found.slice(-most).reverse();
  const all = wanted.length ? `${found.length} found among ${takes.length}` : takes.length;
  return { rows, line: rows.length < takes.length ? `Showing ${rows.length} of ${all}` : "" };
}
