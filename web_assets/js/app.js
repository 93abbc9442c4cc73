// The page: wires panels, safety and the 3-D view to the studio.

import { $, $$, attempt, capital, el, press, text, toast } from "./ui.js";
import { controlLine, get, pageName, post, ticks } from "./net.js";
import { captions, look, reloadView, startView, themeFrame } from "./view.js";
import { count, drawHealth, framesPerSecond, percentile } from "./health.js";
import { DRIVE, heldKeys, keyboard } from "./keys.js";
import { VOCABULARY, meaningOf } from "./vocabulary.js";
import { drawTakes, startTakes } from "./takes.js";
import { startSource, drawSource } from "./source.js";
import { collectKeys, drawCollect, startCollect } from "./collect.js";
import { drawReview, reviewKeys, startReview } from "./review.js";

const SLIDERS = [
  { name: "tilt_gain", title: "Tilt gain", low: 0, high: 2, step: 0.05, show: (v) => `× ${v.toFixed(2)}`, help: "How far the robot leans when you do" },
  { name: "dead_zone", title: "Dead zone", low: 0, high: 0.3, step: 0.005, show: (v) => `${((v * 180) / Math.PI).toFixed(1)}°`, help: "Leaning less than this is ignored" },
  { name: "speed_cap", title: "Speed cap", low: 0, high: 1.5, step: 0.01, show: (v) => `${v.toFixed(2)} m/s`, help: "The robot walks no faster" },
];
const STYLES = { march: "marching in place", circles: "circling your hands", semantic: "marching, read by rule" };
const WALKING = { march: "walking as you march", circles: "walking as you circle your hands", semantic: "walking at the speed your steps say" };
const app = { tick: null, state: null, link: "connecting", lastTick: 0 };
window.a1studio = app; // for tests and the curious

// Safety first: these work even if something below fails.
const line = controlLine({
  heldKeys,
  onState: (state) => { app.state = state; drawState(state); },
  onLink: (link) => {
    if (link === "up" && app.link === "down") reloadView();
    app.link = link;
    drawLink();
  },
});
const actions = {
  stop: () => { if ($("#shortcuts").open) $("#shortcuts").close(); line.stop(); $("#stop").animate([{ scale: 0.94 }, { scale: 1 }], 150); },
  R: () => attempt(() => post("/api/reset")),
  Enter: () => attempt(() => post("/api/arm")),
  T: () => setTheme(document.documentElement.dataset.theme === "dark" ? "light" : "dark"),
  // Not modal: the stop button must stay within reach.
  "?": () => $("#shortcuts").show(),
  ...collectKeys, ...reviewKeys,
  1: () => look("front"), 2: () => look("side"), 3: () => look("behind"), 4: () => look("top"),
};
const driving = () => app.state?.source === "operator:interactive";
const listen = keyboard(actions, driving, (held) => {
  for (const key of $$("#pad kbd")) key.classList.toggle("held", held.has(key.textContent));
  line.say();
});
listen(window);
$("#stop").addEventListener("click", actions.stop);
$("#reset").addEventListener("click", actions.R);
$("#arm").addEventListener("click", actions.Enter);

// Header and commands
for (const button of $$("#mode button"))
  button.addEventListener("click", () => attempt(() => post("/api/mode", { mode: button.dataset.mode })));
for (const button of $$("#lock button"))
  button.addEventListener("click", () => attempt(() => post("/api/state", { state: button.dataset.state })));
for (const button of $$("#style button"))
  button.addEventListener("click", () => attempt(async () => {
    await post("/api/style", { style: button.dataset.style });
    toast(`Walking means ${STYLES[button.dataset.style]} now`, "good");
  }));
$("#theme").addEventListener("click", actions.T);
$("#help").addEventListener("click", actions["?"]);
$("#control").addEventListener("click", () => attempt(async () => {
  const mine = app.state?.control.holder === pageName();
  const state = await post("/api/control", { page: pageName(), action: mine ? "release" : "take" });
  toast(mine ? "Control given up" : "You have control", "good");
  drawState({ ...app.state, ...state });
}));
$("#controller").addEventListener("change", (event) =>
  attempt(() => post("/api/controller", { controller: event.target.value })));

function setTheme(theme) {
  document.documentElement.dataset.theme = theme;
  localStorage.setItem("theme", theme);
  themeFrame();
}
setTheme(localStorage.getItem("theme") ?? (matchMedia("(prefers-color-scheme: light)").matches ? "light" : "dark"));

// What is drawn once
for (const slider of SLIDERS) {
  const output = el("output", { for: slider.name });
  const input = el("input", { type: "range", id: slider.name, min: slider.low, max: slider.high, step: slider.step, title: slider.help });
  input.addEventListener("input", () => text(output, slider.show(+input.value)));
  input.addEventListener("change", () => attempt(() => post("/api/gain", { name: slider.name, value: +input.value })));
  $("#sliders").append(el("label", { class: "slider", title: slider.help }, el("span", {}, slider.title), output, input));
}
for (const item of VOCABULARY) {
  const row = el("li", { "data-id": item.id, ...(item.style ? { "data-style": item.style, hidden: item.style !== "march" } : {}) });
  row.innerHTML = `<svg viewBox="0 0 40 40" aria-hidden="true">${item.svg}</svg>`;
  row.append(el("div", {}, el("b", {}, item.you), el("span", {}, `the robot ${item.it}`)));
  $("#vocabulary").append(row);
}
for (const name of ["stand", "walk", "sit"])
  $("#votes").append(el("div", { class: "vote", "data-name": name }, capital(name), el("i"), el("em", {}, "")));
const rows = [
  ["Esc", "emergency stop, wherever the focus is"], ["Space", "emergency stop, outside controls"],
  ["R", "reset: stand up"], ["Enter", "arm: follow again"], ["1–4", "camera: front, side, behind, above"],
  ["T", "dark or light"], ["?", "this help"],
  ["G V M", "collecting: start, end the preview, abort"], ["K B N", "collecting: keep, redo, next"],
  ["P , . L", "reviewing: play, a frame back or on, loop"], ["I O Z Y", "reviewing: trim here, undo, redo"],
  ...DRIVE.map(([key, what]) => [key, `keyboard driving: ${what}`]),
];
for (const [key, what] of rows) $("#keys").append(el("kbd", {}, key), el("span", {}, what));

startSource(app);
startTakes(app);
startReview(app);
startCollect(app);
startView({ keys: listen, ready: () => $("#veil").classList.add("gone") });

// What changes thirty times a second …
ticks((tick) => {
  app.tick = tick;
  app.lastTick = performance.now();
  app.latency = count(tick);
  for (const row of $$("#votes .vote")) {
    const share = tick.votes[row.dataset.name] ?? 0;
    $("i", row).style.setProperty("--v", share);
    text($("em", row), `${Math.round(100 * share)} %`);
    row.classList.toggle("won", tick.expert === row.dataset.name);
  }
  const now = tick.state === "transition" ? `changing to ${tick.transition_to ?? "…"}` : tick.state;
  text($("#state-now"), now);
  const shown = tick.mode === "collect" || (tick.mode === "replay" && tick.controller === "recorded");
  text($('.caption[data-figure="reference"] b'), shown ? "Shown A1" : "Retargeted A1");
  captions({
    human: tick.human ? (tick.expert === "unknown" ? "motion not known" : `meaning: ${tick.expert}`) : "nobody seen",
    reference: now,
    robot: tick.fallen ? "fallen" : tick.controller.replace("_", " "),
  });
  const meaning = meaningOf(tick);
  for (const row of $$("#vocabulary li")) row.classList.toggle("now", row.dataset.id === meaning);
});

const STOPS = { stopped: "Emergency stop", fallen: "The robot fell", fault: "Stopped by a fault" };
const seen = (s) => (s === null ? "Nobody was seen yet" : `Last human pose ${s.toFixed(1)} s ago`);

// … ten times …
function drawState(state) {
  press($("#mode"), "mode", state.mode);
  press($("#lock"), "state", state.state_lock);
  press($("#style"), "style", state.style);
  for (const row of $$("#vocabulary li[data-style]")) row.hidden = row.dataset.style !== state.style;
  const stopped = Boolean(state.stopped);
  $("#stopped").hidden = !stopped;
  $(".stage").classList.toggle("is-stopped", stopped);
  const needsReset = stopped && state.needs_reset;
  $("#reset").classList.toggle("next", needsReset);
  $("#arm").classList.toggle("next", !needsReset && !state.armed);
  $("#arm").disabled = Boolean(state.armed) && !stopped;
  text($("#stopped b"), STOPS[state.reason] ?? "Stopped");
  text($("#stopped span"), needsReset ? "Its joints are damped. Press Reset to stand up, then Arm." : "It is up again. Press Arm to follow.");
  const status = $("#status");
  status.dataset.kind = stopped ? "stopped" : state.reason ? "wait" : "moving";
  status.dataset.reason = state.reason;
  status.title = seen(state.stale_s);
  const doing = { stand: "standing with you", walk: WALKING[state.style] ?? "walking", sit: "sitting with you", transition: "changing its stance" };
  text($("span", status), state.reason ? capital(state.why)
    : state.mode === "collect" ? "Collecting: the robot shows what to act out"
    : state.mode === "replay" ? "Replaying a take, as it was" : `Following: ${doing[state.state] ?? state.state}`);
  const { holder, pages } = state.control ?? { pages: [] };
  const mine = holder === pageName();
  const watchers = pages.length - 1;
  $("#control").dataset.held = mine ? "you" : holder ? "other" : "none";
  text($("#control"), mine ? `You drive${watchers > 0 ? ` · ${watchers} watching` : ""}` : "Take control");
  for (const slider of SLIDERS) {
    const value = state.gains?.[slider.name], input = $(`#${slider.name}`);
    if (value === undefined || document.activeElement === input) continue;
    input.value = value;
    text($(`output[for="${slider.name}"]`), slider.show(value));
  }
  drawController(state);
  drawSource(state);
  drawTakes(state);
  drawReview(state);
  drawCollect(state);
}

// What each controller does with the reference: what an operator has to know before choosing it.
const CONTROLLER_NOTES = {
  policy: "Trained to balance while it tracks.",
  pd_playback: "The reference straight to the motors, without balance: walking faster than 0.2 m/s it often falls.",
  stand_still: "Holds the neutral pose whatever you do.",
};

function drawController(state) {
  const select = $("#controller");
  const names = state.controllers ?? [state.controller ?? app.tick?.controller].filter(Boolean);
  if (select.dataset.names !== names.join()) {
    select.dataset.names = names.join();
    select.replaceChildren(...names.map((name) => el("option", { value: name }, capital(name.replace("_", " ")))));
  }
  const chosen = state.controller ?? app.tick?.controller ?? "";
  if (document.activeElement !== select) select.value = chosen;
  text($("#controller-note"), CONTROLLER_NOTES[chosen] ?? "");
}

function drawLink() {
  const silent = app.link === "up" && app.lastTick && performance.now() - app.lastTick > 1000;
  const link = silent ? "connecting" : app.link;
  $("#chip-link").dataset.link = link;
  text($("#chip-link b"), { up: "Connected", connecting: silent ? "No ticks" : "Connecting", down: "Disconnected" }[link]);
  if (app.link === "down") {
    $("#status").dataset.kind = "stopped";
    text($("#status span"), "The studio does not answer; trying again. Is a1-studio serve still running?");
  }
}

// … and four times.
setInterval(() => {
  drawLink();
  if (!app.tick) return;
  text($("#chip-fps b"), framesPerSecond().toFixed(0));
  text($("#chip-latency b"), percentile(0.5).toFixed(2));
  text($("#chip-rtt b"), line.roundTrip.toFixed(0));
  drawHealth(app.tick.counters);
}, 250);

get("/api/health").catch((error) => toast(capital(error.message)));
