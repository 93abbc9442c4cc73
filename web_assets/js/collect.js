// Mode collect: plan what to act out, be counted in, act it out, keep it or do it again.

import { $, attempt, capital, el, press, search, text, toast } from "./ui.js";
import { call, get, post } from "./net.js";
import { Metronome } from "./metronome.js";
import { importZone } from "./imports.js";
import { openReview, reviewing } from "./review.js";
import { drawTrain, pickTakes, startTrain } from "./train.js";

const PHASES = {
  setup: "Make a plan to begin", ready: "Ready when you are", preview: "Watch first",
  countdown: "Stand by", record: "Act it out", review: "How was it?", done: "All done",
};
const BUTTONS = [
  { action: "go", key: "G", title: "Start", phases: ["ready"], main: true },
  { action: "skip", key: "V", title: "I have seen it", phases: ["preview"], main: true },
  { action: "keep", key: "K", title: "Keep", phases: ["review"], main: true },
  { action: "redo", key: "B", title: "Redo", phases: ["review"] },
  { action: "next", key: "N", title: "Next", phases: ["ready", "review"] },
  { action: "abort", key: "M", title: "Abort", phases: ["preview", "countdown", "record"] },
];
const metronome = new Metronome();
const ROWS = 80;
const plan = new Map();
const ticks = new Map(); // name: whether to train on it, where that was said since the verdict
let tasks = [], takes = [], last = {}, app = null;

export const collecting = () => app?.state?.mode === "collect";
const act = (action) => attempt(() => post("/api/collect/action", { action }));

// Keys mean these only while collecting; the page's own keys stay what they are.
export const collectKeys = Object.fromEntries(BUTTONS.map(({ action, key, phases }) => [key, () => {
  if (collecting() && phases.includes(app.state.collect?.phase)) act(action);
}]));

function card(id, title, ...content) {
  return el("details", { class: "card work", id, open: true },
    el("summary", {}, title, el("span", { class: "hint", id: `${id}-now` })), ...content);
}

export function startCollect(studio) {
  app = studio;
  const panels = $(".panels");
  panels.prepend(
    card("collect", "Collect",
      el("label", { class: "field" }, el("span", {}, "Who acts"),
        el("input", { type: "text", id: "collect-operator", maxlength: 60, value: localStorage.getItem("operator") ?? "me" })),
      el("div", { class: "plan", id: "plan", role: "group", "aria-label": "How often to act out each task" }),
      el("label", { class: "field" }, el("span", {}, "Seconds each"),
        el("input", { type: "number", id: "collect-seconds", min: 2, max: 60, step: 1, value: 8 })),
      el("div", { class: "row switches" },
        el("label", { class: "switch", title: "Show each motion once before it is recorded" },
          el("input", { type: "checkbox", id: "collect-preview", role: "switch", checked: true }), el("span", {}, "Preview")),
        el("label", { class: "switch", title: "Go on without buttons: takes are kept after four seconds" },
          el("input", { type: "checkbox", id: "collect-free", role: "switch" }), el("span", {}, "Hands free")),
        el("label", { class: "switch", title: "Tick to each step of a gait" },
          el("input", { type: "checkbox", id: "collect-sound", role: "switch", checked: true }), el("span", {}, "Ticks"))),
      el("input", { type: "text", id: "collect-notes", maxlength: 4000, placeholder: "Notes on this session (optional)", "aria-label": "Notes on this session" }),
      el("button", { class: "wide main", id: "collect-begin" }, "Begin")),
    card("library", "Takes", importZone(),
      el("input", { type: "text", id: "collected-find", placeholder: "Find a take by name, label or note", "aria-label": "Find a take", oninput: list }),
      el("p", { class: "note", id: "collected-shown", role: "status" }), el("ul", { class: "takes tall", id: "collected" }),
      el("p", { class: "note", id: "collect-sessions" })),
    card("map", "What is covered", el("div", { id: "map-next", class: "proposals" }), el("div", { id: "map-states", class: "map" })),
    card("train", "Train a mapper of your own", el("div", { id: "train-body" })),
  );
  $(".stage").append(
    el("div", { class: "coach", id: "coach", hidden: true, role: "status", "aria-live": "polite" },
      el("div", { class: "coach-top" }, el("span", { class: "phase" }), el("b", { class: "task" }), el("span", { class: "of" })),
      el("p", { class: "prompt" }),
      el("div", { class: "meter" }, el("i", {})),
      el("div", { class: "feet", "aria-hidden": "true" }, el("i", { "data-foot": "0" }, "L"), el("i", { "data-foot": "1" }, "R")),
      el("p", { class: "why" })),
    el("div", { class: "count", id: "count", hidden: true, "aria-hidden": "true" }),
    el("div", { class: "coach-actions", id: "coach-actions", hidden: true },
      ...BUTTONS.map(({ action, key, title, main }) =>
        el("button", { class: main ? "main" : "", "data-action": action, onclick: () => act(action) }, title, el("kbd", {}, key))),
      el("button", { id: "coach-review", onclick: () => openReview(app.state.collect.take) }, "Look at it")),
  );
  $("#collect-begin").addEventListener("click", () => attempt(begin));
  $("#collect-operator").addEventListener("change", (e) => localStorage.setItem("operator", e.target.value));
  document.addEventListener("takes-changed", () => { refresh(); refreshMap(); });
  metronome.onBeat = (foot) => {
    const dot = $(`#coach .feet [data-foot="${foot}"]`);
    dot.animate([{ transform: "scale(1.35)", background: "var(--human)", color: "#fff" }, { transform: "scale(1)" }], 260);
  };
  startTrain(app);
  get("/api/collect/tasks").then((found) => { tasks = found; drawPlan(); }).catch(() => {});
  refresh();
}

function drawPlan() {
  const groups = ["stand", "walk", "sit"].map((state) => el("fieldset", {}, el("legend", {}, capital(state)),
    ...tasks.filter((t) => t.state === state).map((t) => {
      const count = el("output", {}, "0");
      const change = (by) => {
        const n = Math.min(20, Math.max(0, (plan.get(t.task) ?? 0) + by));
        plan.set(t.task, n);
        text(count, String(n));
        count.closest(".choice").classList.toggle("on", n > 0);
      };
      return el("div", { class: "choice", "data-task": t.task, title: t.prompt },
        el("span", {}, capital(t.task.replace(/^sit_/, "").replaceAll("_", " "))),
        el("button", { "aria-label": `Fewer takes of ${t.task}`, onclick: () => change(-1) }, "−"), count,
        el("button", { "aria-label": `More takes of ${t.task}`, onclick: () => change(1) }, "+"));
    })));
  $("#plan").replaceChildren(...groups);
}

async function begin() {
  metronome.unlock();
  const seconds = +$("#collect-seconds").value;
  const items = tasks.filter((t) => plan.get(t.task)).map((t) => ({ task: t.task, takes: plan.get(t.task), seconds }));
  if (!items.length) { toast("Choose at least one task: press + beside it"); return; }
  $("#collect-begin").disabled = true;
  text($("#collect-begin"), "Drawing motions …");
  try {
    await post("/api/collect/plan", {
      items, operator: $("#collect-operator").value.trim() || "me", notes: $("#collect-notes").value.trim(),
      preview: $("#collect-preview").checked, hands_free: $("#collect-free").checked,
    });
    if (!collecting()) await post("/api/mode", { mode: "collect" });
    $("#collect").open = false; // out of the way of the takes to come
  } finally {
    $("#collect-begin").disabled = false;
    text($("#collect-begin"), "Begin");
  }
}

export async function refresh() {
  try { takes = await get("/api/takes"); } catch { return; }
  list();
  text($("#library-now"), takes.length ? `${takes.filter((t) => t.kept).length} kept of ${takes.length}` : "");
  pickTakes(picked());
  try {
    const sessions = await get("/api/collect/sessions");
    text($("#collect-sessions"), sessions.slice(0, 3).map((s) => `${s.operator}, ${s.day}: ${s.takes.length} takes${s.notes ? ` — ${s.notes}` : ""}`).join(" · "));
  } catch { /* no sessions yet */ }
}

function list() {
  const { rows: shown, line } = search(takes, $("#collected-find").value, ROWS);
  $("#collected-find").hidden = !takes.length;
  text($("#collected-shown"), line);
  $("#collected-shown").hidden = !line;
  const rows = shown.map((take) => {
    const score = take.score == null ? null : Math.round(100 * take.score);
    const badge = take.kept === true ? "kept" : take.kept === false ? "rejected" : "new";
    return el("li", { class: badge, "data-name": take.name },
      el("input", { type: "checkbox", "aria-label": `Train on ${take.name}`, title: "Train on it", checked: ticked(take),
        onchange: (e) => { ticks.set(take.name, { kept: take.kept, on: e.target.checked }); pickTakes(picked()); } }),
      el("div", { class: "name", title: take.name }, el("b", {}, (take.label || take.name).replaceAll("_", " ")),
        el("span", {}, `${(take.trim ? take.trim[1] - take.trim[0] : take.seconds).toFixed(1)} s${take.lag ? ` · lag ${take.lag.toFixed(2)} s` : ""}${take.recovered ? " · recovered" : ""}`)),
      score == null ? el("em", {}, badge === "rejected" ? "redone" : "") : el("em", { class: "score", style: { "--s": score }, title: "Quality" }, String(score)),
      el("button", { title: "Scrub, trim, align, judge", onclick: () => openReview(take.name) }, "Review"));
  });
  $("#collected").replaceChildren(...(takes.length ? rows : [el("li", { class: "empty" }, "Nothing yet. What you act out appears here.")]));
}

// Whether or not a row of the list shows it: kept, unless its box was ticked or cleared since.
function ticked(take) {
  const said = ticks.get(take.name);
  return said && said.kept === take.kept ? said.on : take.kept === true;
}
const picked = () => [...takes].reverse().filter(ticked).map((take) => take.name);

async function refreshMap() {
  if (!collecting() && !reviewing()) return;
  let map;
  try { map = await get("/api/collect/map"); } catch { return; }
  $("#map-next").replaceChildren(...map.proposals.slice(0, 3).map((p) => el("div", { class: "proposal" },
    el("div", {}, el("b", {}, capital(p.task.replaceAll("_", " "))), el("span", {}, p.why)),
    el("button", { title: "Add two takes of it to the plan", onclick: () => attempt(async () => {
      await post("/api/collect/add", { items: [{ task: p.task, takes: 2, seconds: +$("#collect-seconds").value }] });
      toast(`Two takes of ${p.task.replaceAll("_", " ")} are in the plan`, "good");
    }) }, "+ Record"))));
  const bins = (axis) => axis.counts.map((n, i) => el("i", {
    class: n ? "" : "none", style: { "--v": Math.min(1, n / map.enough).toFixed(2) },
    title: `${axis.edges[i]} to ${axis.edges[i + 1]} ${axis.unit}: ${n} frames`,
  }));
  const axisRow = (axis) => el("div", { class: "axis" }, el("span", {}, capital(axis.name)), el("div", { class: "bins" }, ...bins(axis)));
  $("#map-states").replaceChildren(...Object.entries(map.states).map(([state, row]) => el("div", { class: "mapstate" },
    el("h4", {}, capital(state), el("span", {}, `${Math.round(100 * row.share)} % covered · ${row.seconds.toFixed(0)} s`)),
    ...row.axes.map(axisRow))));
  const share = Object.values(map.states).map((s) => s.share);
  text($("#map-now"), `${Math.round((100 * share.reduce((a, b) => a + b, 0)) / share.length)} %`);
}

// Ten times a second, with the state.
export function drawCollect(state) {
  const c = state.collect;
  if (!c) return;
  const on = state.mode === "collect";
  document.body.dataset.work = on || reviewing() ? "collect" : "";
  $("#coach").hidden = $("#coach-actions").hidden = !on || reviewing();
  $("#count").hidden = !(on && c.phase === "countdown");
  if (on && (c.phase !== last.phase || c.done !== last.done || !last.on)) { refresh(); if (!["record", "countdown"].includes(c.phase)) refreshMap(); }
  if (on) {
    const coach = $("#coach");
    coach.dataset.phase = c.phase;
    text($(".phase", coach), PHASES[c.phase]);
    text($(".task", coach), c.task && c.phase !== "done" ? capital(c.task.replaceAll("_", " ")) : c.phase === "done" ? `${c.kept.length} takes kept` : "");
    text($(".of", coach), c.task && c.phase !== "done" ? `take ${Math.min(c.done + 1, c.total)} of ${c.total}` : "");
    text($(".prompt", coach), c.phase === "done" ? "Review them below, or train a mapper of your own." : c.phase === "setup" ? "Choose tasks on the right, then Begin." : c.phase === "countdown" || c.phase === "ready" ? `${c.prompt}. ${c.state === "sit" ? "Sit" : "Stand"} quietly until it moves.` : c.prompt ?? "");
    const runs = ["preview", "record", "countdown"].includes(c.phase) || (c.phase === "review" && c.remaining != null);
    const whole = c.t + (c.remaining ?? 0);
    $(".meter", coach).style.visibility = runs ? "visible" : "hidden";
    $(".meter i", coach).style.transform = `scaleX(${runs && whole ? (c.t / whole).toFixed(4) : 0})`;
    $(".feet", coach).hidden = !(c.beats?.length && ["preview", "record"].includes(c.phase));
    text($(".why", coach), c.why ?? "");
    $(".why", coach).hidden = !c.why;
    if (c.phase === "countdown") text($("#count"), String(Math.max(1, Math.ceil(c.remaining - 1e-6))));
    for (const button of $("#coach-actions").querySelectorAll("[data-action]")) {
      const rule = BUTTONS.find((b) => b.action === button.dataset.action);
      button.hidden = !rule.phases.includes(c.phase);
    }
    $("#coach-review").hidden = !(c.phase === "review" && c.take);
    const beating = c.beats?.length && ["preview", "record"].includes(c.phase);
    if (beating) metronome.follow(c.beats, c.t, $("#collect-sound").checked);
    else metronome.stop();
    if (c.phase === "countdown" && Math.ceil(c.remaining) !== last.second) { last.second = Math.ceil(c.remaining); if ($("#collect-sound").checked) metronome.click(440, 0.05); }
    text($("#collect-now"), c.total ? `${c.done} of ${c.total} done` : "");
  } else metronome.stop();
  last = { ...last, phase: c.phase, done: c.done, on };
  press($("#mode"), "mode", state.mode);
  drawTrain(state);
}

export { call };
