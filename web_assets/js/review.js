// Reviewing a take: a timeline of both sides under the 3-D view; scrub, trim, align, clean, judge.

import { $, attempt, capital, el, press, text, toast } from "./ui.js";
import { call, get, post } from "./net.js";
import { Timeline } from "./timeline.js";

const EXPORTS = [["npz", "NPZ: both sides"], ["csv", "CSV: both sides"], ["bvh", "BVH: the person"], ["jsonl", "JSON lines: the person"],
  ["pairs", "Pairs as Parquet"], ["hdf5", "HDF5"], ["lerobot", "LeRobot data set"], ["html", "Replay as a web page"]];
const FLAWS = 40; // with a button of their own; the next come up as these are cut out
const SPEEDS = [0.25, 0.5, 1, 2, 4];
let app = null, name = null, info = null, found = null, before = null, timeline = null, came = "live", aligned = true;

export const reviewing = () => name !== null;

const take = (path = "") => `/api/takes/${name}${path}`;
const edit = (changes) => attempt(async () => { info = await call("PATCH", take(), changes); await reload(); });
const step = (which) => attempt(async () => { info = await post(take(`/${which}`)); await reload(); });

export const reviewKeys = {
  P: () => name && play(),
  ",": () => name && nudge(-1), ".": () => name && nudge(1),
  I: () => name && trimTo(0), O: () => name && trimTo(1),
  Z: () => name && info.undoable && step("undo"), Y: () => name && info.redoable && step("redo"),
  L: () => name && loop(),
};

export function startReview(studio) {
  app = studio;
  const button = (id, label, title, onclick, key) => el("button", { id, title, onclick }, label, key ? el("kbd", {}, key) : null);
  $(".stage").append(el("section", { class: "bench", id: "bench", hidden: true, "aria-label": "Review of a take" },
    el("div", { class: "bench-bar" },
      el("button", { class: "icon", id: "bench-close", title: "Close the review", "aria-label": "Close the review", onclick: closeReview }, "✕"),
      el("input", { type: "text", id: "bench-label", maxlength: 120, "aria-label": "Label of the take", onchange: (e) => edit({ label: e.target.value.trim() }) }),
      el("div", { class: "segmented small", id: "bench-keep", role: "group", "aria-label": "Verdict" },
        el("button", { "data-keep": "true", onclick: () => edit({ keep: true }) }, "Keep"),
        el("button", { "data-keep": "false", onclick: () => edit({ keep: false }) }, "Reject")),
      el("em", { class: "score big", id: "bench-score", title: "Quality, from 0 to 100" }),
      el("span", { class: "note", id: "bench-why" }),
      el("div", { class: "bench-right" },
        button("bench-undo", "↶", "Take the last edit back (Z)", () => step("undo")),
        button("bench-redo", "↷", "Do it again (Y)", () => step("redo")),
        el("select", { id: "bench-export", "aria-label": "Export the take", onchange: (e) => save(e.target) },
          el("option", { value: "" }, "Export"), ...EXPORTS.map(([format, title]) => el("option", { value: format }, title))),
        button("bench-split", "Split", "Two takes, cut here", split),
        button("bench-bin", "Bin", "Throw the take into the bin", bin))),
    el("div", { class: "bench-line" }, el("canvas", { id: "timeline", role: "img", "aria-label": "Both sides over time" })),
    el("div", { class: "bench-bar" },
      button("bench-play", "▶", "Play or pause (P)", play),
      el("select", { id: "bench-speed", "aria-label": "Speed", onchange: (e) => seek({ speed: +e.target.value }) },
        ...SPEEDS.map((s) => el("option", { value: s, selected: s === 1 }, `× ${s}`))),
      button("bench-loop", "⟳", "Again and again (L)", loop),
      el("output", { id: "bench-time" }),
      el("div", { class: "legend2" }, el("i", { class: "h" }), "You", el("i", { class: "r" }), "Shown"),
      el("div", { class: "align", id: "bench-align" }),
      el("div", { class: "found", id: "bench-found" })),
  ));
  timeline = new Timeline($("#timeline"), { seek: (t) => seek({ t, playing: false }), trim: (range) => edit({ trim: range }) });
}

const seek = (body) => attempt(() => post("/api/seek", body));
const now = () => app.state?.replay ?? { t: 0, playing: false, loop: false, speed: 1 };
function play() { seek({ playing: !now().playing }); }
function nudge(by) { seek({ t: Math.max(0, now().t + by / 30), playing: false }); }
function loop() { seek({ loop: !now().loop, playing: true }); }
function trimTo(end) {
  const range = [...(info.trim ?? [0, info.seconds])];
  range[end] = Math.round(1000 * now().t) / 1000;
  if (range[0] < range[1]) edit({ trim: range });
}
const split = () => attempt(async () => {
  const { takes } = await post(take("/split"), { at: now().t });
  toast(`Split: ${takes[1].name} is the rest`, "good");
  await reload();
  changed();
});
const bin = () => attempt(async () => {
  const gone = name;
  await call("DELETE", take());
  await closeReview();
  const note = el("button", { onclick: () => attempt(async () => { await post(`/api/takes/${gone}/restore`); changed(); openReview(gone); }) }, "Bring it back");
  toast(`${gone} is in the bin`, "good");
  $("#toasts .toast:last-child")?.append(" ", note);
  changed();
});

function save(select) {
  el("a", { href: take(`/export?format=${select.value}`), download: "" }).click();
  select.value = "";
}

const changed = () => document.dispatchEvent(new CustomEvent("takes-changed"));

export const openReview = (which) => attempt(async () => {
  if (!name) came = app.state?.mode === "replay" ? "live" : app.state?.mode ?? "live";
  info = await get(`/api/takes/${which}`);
  name = which;
  found = null;
  aligned = true;
  document.body.dataset.work = "collect";
  $("#bench").hidden = false;
  $(".stage").classList.add("has-bench");
  await post(take("/show"), { t: info.trim?.[0] ?? 0, playing: false, speed: 1, loop: false });
  await reload(false);
});

export async function closeReview() {
  name = null;
  $("#bench").hidden = true;
  $(".stage").classList.remove("has-bench");
  await attempt(() => post("/api/mode", { mode: came }));
  changed();
}

async function reload(show = true) {
  const { t, playing, speed, loop: again } = now();
  const which = name;
  const [curves, review, raw] = await Promise.all([
    get(take(`/timeline?points=500&aligned=${aligned}`)), get(take("/review")),
    found || !aligned ? before : get(take("/timeline?points=500&aligned=false"))]);
  if (which !== name) return;
  found = review;
  before = raw ?? curves;
  info = await get(take());
  if (show) await post(take("/show"), { t, playing, speed, loop: again, aligned });
  timeline.load(curves, info, review.suggestions);
  draw();
  if (show) changed();
}

function draw() {
  $("#bench-label").value = info.label || "";
  $("#bench-label").placeholder = name;
  press($("#bench-keep"), "keep", String(info.kept));
  const score = Math.round(found.quality.score);
  text($("#bench-score"), String(score));
  $("#bench-score").style.setProperty("--s", score);
  text($("#bench-why"), found.quality.reasons.map((r) => r.message).join(" · ") || "nothing to find fault with");
  $("#bench-undo").disabled = !info.undoable;
  $("#bench-redo").disabled = !info.redoable;
  drawAlign();
  const list = found.suggestions;
  const clean = (body) => attempt(async () => { await post(take("/clean"), body); await reload(); });
  $("#bench-found").replaceChildren(...(list.length ? [
    el("button", { title: list.map((s) => `${s.start.toFixed(2)} s: ${s.message}`).join("\n"), onclick: () => clean({}) },
      `Cut out ${list.length} flaw${list.length > 1 ? "s" : ""}`),
    ...(list.length > 1 ? list.slice(0, FLAWS) : []).map((s, i) =>
      el("button", { class: "one", title: `Cut out this one only: ${s.message}`, "aria-label": `Cut out at ${s.start.toFixed(2)} s: ${s.message}`, onclick: () => clean({ which: [i] }) },
        `${s.start.toFixed(1)} s`))] : []));
}

function drawAlign() {
  const { found: proposed, before: as } = found;
  const box = $("#bench-align");
  if (!proposed || !as) { box.replaceChildren(el("span", { class: "note" }, "nothing moves: no lag to find")); return; }
  const off = Math.abs(proposed.lag - as.lag) > 0.5 / 30;
  const numbers = `${as.correlation.toFixed(2)} → ${proposed.correlation.toFixed(2)}`;
  const accept = (warp) => attempt(async () => {
    const done = await post(take("/align"), { accept: true, warp });
    await reload();
    if (warp && !done.warped) toast("Evening out the tempo would not agree better: aligned by the lag alone", "good");
  });
  const compare = el("button", { "aria-pressed": !aligned, title: "Show it as it was recorded, or as it is aligned", onclick: () => { aligned = !aligned; attempt(() => reload()); } }, aligned ? "Before" : "After");
  box.replaceChildren(...(off && info.lag !== 0 ? [
    el("span", {}, `You are `, el("b", {}, `${(proposed.lag - as.lag).toFixed(2)} s`), ` late · agreement ${numbers}`),
    el("button", { class: "main", id: "align-accept", onclick: () => accept(false) }, "Align"),
    el("button", { title: "Also even out tempo", onclick: () => accept(true) }, "with warp"),
    el("button", { title: "Leave it as it was acted", id: "align-refuse", onclick: () => attempt(async () => { await post(take("/align"), { accept: false }); await reload(); }) }, "Leave"),
  ] : [
    el("span", {}, info.lag ? `Aligned by ${info.lag.toFixed(2)} s${info.warped ? " and warped" : ""} · agrees ${as.correlation.toFixed(2)}` : info.lag === 0 ? "Left as acted" : `In time · agrees ${as.correlation.toFixed(2)}`),
    info.lag ? compare : el("button", { onclick: () => accept(false) }, "Align"),
    info.lag && !info.warped ? el("button", { id: "align-warp", title: "Also even out tempo", onclick: () => accept(true) }, "with warp") : "",
  ]));
}

// Ten times a second, with the state.
export function drawReview(state) {
  if (!name) return;
  const replay = state.replay;
  if (!replay || replay.name !== name) {
    if (state.mode !== "replay" && $("#bench").hidden === false && state.mode !== came) { name = null; $("#bench").hidden = true; $(".stage").classList.remove("has-bench"); }
    return;
  }
  text($("#bench-play"), replay.playing ? "❚❚" : "▶");
  $("#bench-loop").setAttribute("aria-pressed", replay.loop);
  if (document.activeElement !== $("#bench-speed")) $("#bench-speed").value = replay.speed;
  text($("#bench-time"), `${replay.t.toFixed(2)} / ${info.seconds.toFixed(2)} s`);
  timeline.at(replay.t, replay.playing ? replay.speed : 0);
}

export { capital };
