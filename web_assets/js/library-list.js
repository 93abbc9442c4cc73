// Which takes the library lists, in which order, and what it says of them: without a page.

import { spoken } from "./words.js";

/** @import { CollectSession, Take } from "../types/page.js" */

export const VERDICTS = /** @type {const} */ (["all", "kept", "new", "rejected"]);
/** What a take was found to be. @param {Pick<Take, "kept">} take */
export const verdictOf = ({ kept }) =>
  kept === true ? "kept" : kept === false ? "rejected" : "new";

/** @param {Pick<Take, "started" | "name">} take */
const age = ({ started, name }) => `${started} ${name}`;
/** s that a take is kept for. @param {Pick<Take, "trim" | "seconds">} take */
export const length = ({ trim, seconds }) => (trim ? trim[1] - trim[0] : seconds);

/** @type {Record<string, (a: Take, b: Take) => number>} */
const ORDERS = {
  newest: (a, b) => age(b).localeCompare(age(a)),
  oldest: (a, b) => age(a).localeCompare(age(b)),
  best: (a, b) => (b.score ?? -1) - (a.score ?? -1),
  worst: (a, b) => (a.score ?? 2) - (b.score ?? 2),
  longest: (a, b) => length(b) - length(a),
  name: (a, b) => (a.label || a.name).localeCompare(b.label || b.name),
};

/**
 * The session that each take belongs to, where it belongs to one.
 *
 * @template {Pick<CollectSession, "takes">} T
 * @param {T[]} sessions
 */
export const sessionsOf = (sessions) =>
  new Map(sessions.flatMap((one) => one.takes.map((take) => [take, one])));

/**
 * The takes in which each typed word occurs, with this verdict, of this session, in this order.
 *
 * @param {Take[]} takes
 * @param {{ words: string, verdict: string, session: string, order: string }} wanted
 * @param {Map<string, Pick<CollectSession, "name" | "operator" | "day">>} sessions by take
 */
export function listed(takes, { words, verdict, session, order }, sessions) {
  const asked = plain(words).split(/\s+/).filter(Boolean);
  return takes
    .filter((take) => {
      const its = sessions.get(take.name);
      if (verdict !== "all" && verdictOf(take) !== verdict) return false;
      if (session && its?.name !== session) return false;
      const said = [take.name, take.label, take.note, take.source, its?.operator, its?.day];
      return asked.every((word) => plain(said.join(" ")).includes(word));
    })
    .toSorted(ORDERS[order] ?? ORDERS.newest);
}

/** @param {string} said */
const plain = (said) => spoken(said.toLowerCase());

/** Bytes as people say them. @param {number} bytes */
export const space = (bytes) =>
  bytes < 1e6
    ? `${Math.ceil(bytes / 1e3)} kB`
    : `${(bytes / 1e6).toFixed(Number(bytes < 1e7))} MB`;

/** A moment as people say it. @param {string} iso */
export function moment(iso) {
  const at = new Date(iso);
  if (Number.isNaN(at.getTime())) return "";
  return at.toLocaleString(undefined, {
    day: "numeric",
    month: "short",
    hour12: false,
    hour: "2-digit",
    minute: "2-digit",
  });
}

/**
 * What became of many takes, in a line: some may have been refused.
 *
 * @param {string} what as "kept"
 * @param {string[]} done
 * @param {Record<string, string>} refused
 */
export function became(what, done, refused) {
  const why = Object.entries(refused);
  const all = done.length + why.length;
  const few = why.slice(0, 3).map(([name, reason]) => `${name}: ${reason}`);
  if (why.length > few.length) few.push(`and ${why.length - few.length} more`);
  const how = why.length ? `${done.length} of ${all} takes ${what}` : `${takesOf(all)} ${what}`;
  return [how, ...few].join(" · ");
}

/** @param {number} count */
export const takesOf = (count) => `${count} take${count === 1 ? "" : "s"}`;
