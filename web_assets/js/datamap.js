// What the takes cover: a bin a range of each axis, and what to record next.

import { $, attempt, el, text, toast } from "./dom.js";
import { capital, spoken } from "./words.js";

/** @import { Axis, CoverageMap, Task } from "../types/page.js" */
/** @import { Studio } from "./studio.js" */

const PROPOSALS = 3;
const MORE = 2; // takes that a proposal adds to the plan

/** @param {Studio} studio @param {() => number} seconds how long a proposed motion is */
export async function drawMap(studio, seconds) {
  const { api } = studio;
  const map = await api.get("/api/collect/map").catch(() => null);
  if (!map) return;
  const add = async (/** @type {Task["task"]} */ task) => {
    await api.post("/api/collect/add", { items: [{ task, takes: MORE, seconds: seconds() }] });
    toast(`Two takes of ${spoken(task)} are in the plan`, "good");
  };
  const proposals = map.proposals.slice(0, PROPOSALS).map(({ task, why }) => {
    const onclick = () => attempt(() => add(task));
    return el(
      "div",
      { class: "proposal" },
      el("div", {}, el("b", {}, capital(spoken(task))), el("span", {}, why)),
      el("button", { title: "Add two takes of it to the plan", onclick }, "+ Record"),
    );
  });
  $("#map-next").replaceChildren(...proposals);
  $("#map-states").replaceChildren(...states(map));
  const shares = Object.values(map.states).map(({ share }) => share);
  const mean = shares.reduce((sum, share) => sum + share, 0) / shares.length;
  text($("#map-now"), `${Math.round(100 * mean)} %`);
}

/** @param {CoverageMap} map */
function states({ states, enough }) {
  return Object.entries(states).map(([state, { share, seconds, axes }]) => {
    const covered = `${Math.round(100 * share)} % covered · ${seconds.toFixed(0)} s`;
    return el(
      "div",
      { class: "mapstate" },
      el("h2", {}, capital(state), el("span", {}, covered)),
      ...axes.map((axis) =>
        el(
          "div",
          { class: "axis" },
          el("span", {}, capital(axis.name)),
          el("div", { class: "bins" }, ...bins(axis, enough)),
        ),
      ),
    );
  });
}

/** @param {Axis} axis @param {number} enough frames that fill a bin */
function bins({ counts, edges, unit }, enough) {
  return counts.map((count, i) =>
    el("i", {
      class: count ? "" : "none",
      style: { "--v": Math.min(1, count / enough).toFixed(2) },
      title: `${edges[i]} to ${edges[i + 1]} ${unit}: ${count} frames`,
    }),
  );
}
