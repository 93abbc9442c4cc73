// The page: wires panels, safety and the 3-D view to the studio.

import { Alarm, drawStale } from "./alarm.js";
import { CollectPanels } from "./collect.js";
import { Controls } from "./controls.js";
import { $, $$, attempt, openDialog, text, toast } from "./dom.js";
import { Drops } from "./drops.js";
import { drawHealth } from "./health.js";
import { TickHistory } from "./history.js";
import { Importer } from "./imports.js";
import { Keyboard } from "./keys.js";
import { ControlLine, ticks } from "./net.js";
import { ReplayBar } from "./replay.js";
import { Review } from "./review.js";
import { Shortcuts } from "./shortcuts.js";
import { SourcePanel } from "./source.js";
import { drawLink, drawStatus } from "./status.js";
import { Studio } from "./studio.js";
import { TakesPanel } from "./takes.js";
import { View } from "./view.js";
import { drawMeaning, drawStyle, startVocabulary } from "./vocabulary.js";
import { capital, spoken } from "./words.js";

/** @import { State, Tick } from "../types/page.js" */

const studio = new Studio();
const { api } = studio;
Object.assign(window, { a1studio: studio }); // for tests and the curious

// Safety first: these work even if something below fails.
const alarm = new Alarm();
const line = new ControlLine(api, {
  heldKeys: () => keyboard.held,
  onState: (state) => {
    studio.state = state;
    drawState(state);
  },
  onLink: (link) => {
    if (link === "up" && ["down", "locked"].includes(studio.link)) view.reload();
    studio.link = link;
    drawConnection();
  },
  onDelivered: alarm.delivered,
});
/** @type {Record<string, () => unknown> & { stop: () => void }} */
const actions = {
  stop: () => {
    alarm.pressed(() => api.post("/api/stop").then(alarm.delivered, () => {}));
    line.stop();
    openDialog()?.close();
    $("#stop").animate([{ scale: 0.94 }, { scale: 1 }], 150);
  },
  // Closes what is open where nothing can be in danger; in doubt it is a stop.
  escape: () => {
    const dialog = openDialog();
    if (dialog && studio.still) dialog.close();
    else actions.stop();
  },
  R: () => attempt(() => api.post("/api/reset")),
  Enter: () => attempt(() => api.post("/api/arm")),
};
const keyboard = new Keyboard(
  actions,
  () => source.driving,
  (held) => {
    for (const key of $$("#pad kbd"))
      key.classList.toggle("held", held.has(key.textContent ?? ""));
    line.say();
  },
);
keyboard.listen(window);
$("#stop").addEventListener("click", actions.stop);
$("#reset").addEventListener("click", actions.R);
$("#arm").addEventListener("click", actions.Enter);

const shortcuts = new Shortcuts();
const source = new SourcePanel(studio);
const controls = new Controls(studio);
const review = new Review(studio);
const takes = new TakesPanel(studio, review.open);
const replay = new ReplayBar(studio);
const importer = new Importer(studio, review.open);
const collect = new CollectPanels(studio, review, importer);
const drops = new Drops(source, importer);
const history = new TickHistory(performance.now());
startVocabulary();
const view = new View({
  listen: (target) => keyboard.listen(target),
  ready: () => $("#veil").classList.add("gone"),
  drag: drops.drag,
});
Object.assign(actions, collect.coach.keys, review.keys, {
  1: () => view.look("front"),
  2: () => view.look("side"),
  3: () => view.look("behind"),
  4: () => view.look("top"),
  T: () => setTheme(document.documentElement.dataset.theme === "dark" ? "light" : "dark"),
  "?": shortcuts.show,
});
$("#theme").addEventListener("click", actions.T);
$("#help").addEventListener("click", actions["?"]);
$("#control").addEventListener("click", () => attempt(takeControl));
const light = matchMedia("(prefers-color-scheme: light)").matches;
setTheme(localStorage.getItem("theme") ?? (light ? "light" : "dark"));

/** @param {string} theme */
function setTheme(theme) {
  document.documentElement.dataset.theme = theme;
  localStorage.setItem("theme", theme);
  view.theme();
}

/** Whether this page drives. @param {State | null} state */
const driven = (state) => state !== null && state.control.holder === api.page;

/** Take control, or give it up. */
async function takeControl() {
  const mine = driven(studio.state);
  const action = mine ? "release" : "take";
  studio.state = await api.post("/api/control", { page: api.page ?? "", action });
  toast(mine ? "Control given up" : "You have control", "good");
  drawState(studio.state);
}

// What changes thirty times a second …
ticks((tick) => {
  studio.tick = tick;
  studio.lastTick = performance.now();
  history.add(tick, studio.lastTick);
  studio.stillness.add(tick, studio.lastTick);
  controls.drawVotes(tick);
  drawCaptions(tick);
  drawMeaning(tick);
});

/** @param {Tick} tick */
function drawCaptions({ mode, state, transition_to, controller, human, expert, fallen }) {
  const now = state === "transition" ? `changing to ${transition_to ?? "…"}` : state;
  text($("#state-now"), now);
  const shown = mode === "collect" || (mode === "replay" && controller === "recorded");
  text($('.caption[data-figure="reference"] b'), shown ? "Shown A1" : "Retargeted A1");
  const meaning = expert === "unknown" ? "motion not known" : `meaning: ${expert}`;
  view.caption({
    human: human ? meaning : "nobody seen",
    reference: now,
    robot: fallen ? "fallen" : spoken(controller),
  });
}

// … ten times …
/** @param {State} state */
function drawState(state) {
  drawStatus(state);
  drawControl(state);
  drawStyle(state);
  controls.draw(state);
  source.draw(state);
  takes.draw(state);
  replay.draw(state);
  review.draw(state);
  collect.draw(state);
}

/** @param {State} state */
function drawControl(state) {
  const mine = driven(state);
  const { holder, pages } = state.control;
  const others = pages.length - 1;
  $("#control").dataset.held = mine ? "you" : holder ? "other" : "none";
  const driving = others > 0 ? `You drive · ${others} watching` : "You drive";
  text($("#control"), mine ? driving : "Take control");
}

// … and four times.
function drawConnection() {
  drawLink(studio.link, studio.silent);
  drawStale(studio);
  alarm.draw();
}

setInterval(() => {
  drawConnection();
  if (!studio.tick) return;
  text($("#chip-fps b"), history.rate.toFixed(0));
  text($("#chip-latency b"), history.percentile(0.5).toFixed(2));
  text($("#chip-rtt b"), line.roundTrip.toFixed(0));
  drawHealth(history, studio.tick.counters);
}, 250);

api.get("/api/health").catch((error) => toast(capital(error.message)));
