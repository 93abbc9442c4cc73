// The page: wires panels, safety and the 3-D view to the studio.

import { Alarm, drawStale } from "./alarm.js";
import { drawBehind } from "./behind.js";
import { captionsOf } from "./captions.js";
import { Controls } from "./controls.js";
import { $, $$, attempt, calm, hears, leave, openDialog, text, toast } from "./dom.js";
import { CollectDoor, LibraryDoor, PlotsDoor, ReviewDoor } from "./doors.js";
import { Drops } from "./drops.js";
import { FilmButton } from "./film-button.js";
import { Guide } from "./guide.js";
import { TickHistory } from "./history.js";
import { drawControl, startHolding } from "./holding.js";
import { Keyboard } from "./keys.js";
import { ControlLine } from "./net.js";
import { startPad } from "./pad.js";
import { PaletteDoor } from "./palette-door.js";
import { PlaceDoor } from "./place-door.js";
import { PushDoor } from "./push-door.js";
import { SceneDoor } from "./scene-door.js";
import { LastingSocket } from "./socket.js";
import { SourcePanel } from "./source.js";
import { drawLink, drawStatus } from "./status.js";
import { Studio } from "./studio.js";
import { TakesPanel } from "./takes.js";
import { TransportBar } from "./transport.js";
import { drawUnderWay } from "./underway.js";
import { View } from "./view.js";
import { drawMeaning, drawStyle, startVocabulary } from "./vocabulary.js";
import { cameraPanel } from "./webcam-panel.js";
import { capital } from "./words.js";

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
    if (!calm()) $("#stop").animate([{ scale: 0.94 }, { scale: 1 }], 150);
  },
  // Closes what is open where nothing can be in danger; in doubt it is a stop.
  escape: () => {
    const dialog = openDialog();
    if (dialog && studio.still) leave(dialog);
    else actions.stop();
  },
  R: async () => {
    // The next thing to do: Enter arms, wherever the focus was.
    if (await attempt(() => api.post("/api/reset"))) $("#arm").focus();
  },
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
hears(".safety");

const shortcuts = () => attempt(async () => (await import("./shortcuts.js")).show());
const source = new SourcePanel(studio);
const controls = new Controls(studio);
const plots = new PlotsDoor(studio);
const review = new ReviewDoor(studio, (take, t) => film.take(take, t), plots);
const takes = new TakesPanel(studio, review.open);
const transport = new TransportBar(studio, () => review.on);
const collect = new CollectDoor(studio, review);
const library = new LibraryDoor(studio, { review: review.open, train: collect.trainOn });
const scenes = new SceneDoor(studio);
const drops = new Drops(source, collect.take);
const history = new TickHistory();
startVocabulary();
startPad(keyboard);
cameraPanel(api, $(".panels > .card + .card"), (target) => keyboard.listen(target));
const guide = new Guide({
  drive: source.drive,
  sample: source.sample,
  record: async () => {
    if (studio.state?.reason === "source_ended") await source.sample();
    $("#record").click();
  },
  review: takes.reviewLast,
  train: collect.keepAndTrain,
  live: () => api.post("/api/mode", { mode: "live" }),
});
$("#guide-again").addEventListener("click", guide.begin);
const push = new PushDoor(studio, () => view);
const place = new PlaceDoor(studio, () => view);
/** @type {View} */
const view = new View({
  listen: (target) => {
    keyboard.listen(target);
    place.listen(target);
    push.listen(target);
  },
  ready: () => {
    performance.mark("figures");
    $("#veil").classList.add("gone");
    collect.soon();
    plots.soon();
    import("./health.js").then(({ drawHealth }) =>
      setInterval(() => studio.tick && drawHealth(history, studio.tick.counters), 250),
    );
  },
  drag: drops.drag,
  newest: () => studio.tick,
});
/** @type {FilmButton} */
const film = new FilmButton(studio, view);
const palette = new PaletteDoor(() => [
  ...transport.entries,
  ...scenes.entries,
  ...place.entries,
  { words: "Emergency stop", key: "Esc", run: actions.stop },
  { words: "Reset: stand up", key: "R", run: actions.R },
  { words: "Arm: follow again", key: "Enter", run: actions.Enter },
  { words: "Library of takes", key: "U", run: library.open },
  { words: "Film the 3-D view", run: film.toggle },
  { words: "Plots", key: "J", run: plots.toggle },
  { words: "Dark or light", key: "T", run: otherTheme },
  { words: "Keyboard shortcuts", key: "?", run: shortcuts },
]);
keyboard.also({
  ...collect.keys,
  ...oneOf(transport.keys, review.keys),
  ...scenes.keys,
  ...push.keys,
  ...place.keys,
  ...view.keys,
  T: otherTheme,
  H: () => $("#record").click(),
  J: plots.toggle,
  U: library.open,
  "?": shortcuts,
  palette: palette.open,
});
$("#theme").addEventListener("click", otherTheme);
$("#help").addEventListener("click", shortcuts);
startHolding(studio, () => studio.state && drawState(studio.state));
const light = matchMedia("(prefers-color-scheme: light)").matches;
setTheme(localStorage.getItem("theme") ?? (light ? "light" : "dark"));

/**
 * Keys that play what is played, or what is on the bench: at most one of the two does something.
 *
 * @param {Record<string, () => unknown>} first @param {Record<string, () => unknown>} second
 */
function oneOf(first, second) {
  const both = Object.keys(first).filter((key) => key in second);
  const joined = both.map((key) => [key, () => (review.on ? second : first)[key]()]);
  return { ...first, ...second, ...Object.fromEntries(joined) };
}

/** @param {string} theme */
function setTheme(theme) {
  document.documentElement.dataset.theme = theme;
  localStorage.setItem("theme", theme);
  view.theme();
}

function otherTheme() {
  setTheme(document.documentElement.dataset.theme === "dark" ? "light" : "dark");
}

// What changes thirty times a second …
/** @param {Tick} tick */
function drawTick(tick) {
  studio.tick = tick;
  studio.lastTick = performance.now();
  history.add(tick, studio.lastTick);
  plots.add(tick);
  scenes.add(tick);
  studio.stillness.add(tick, studio.lastTick);
  controls.drawVotes(tick);
  const captions = captionsOf(tick, studio.state);
  view.caption(captions);
  view.besides.add(tick, studio.state);
  text($("#state-now"), captions.reference[1]);
  drawMeaning(tick);
  drawUnderWay(tick, source.driving && keyboard.held.includes("W"));
}
new LastingSocket("/api/ticks", { heard: drawTick });

// … ten times …
/** @param {State} state */
function drawState(state) {
  drawStatus(state, api.page);
  view.beside(Object.keys(state.props).length > 0);
  drawBehind(state.link);
  drawControl(studio, state);
  drawStyle(state);
  controls.draw(state);
  source.draw(state);
  takes.draw(state);
  transport.draw(state);
  scenes.draw(state);
  review.draw(state);
  collect.draw(state);
  guide.draw(state);
}

// … and four times.
function drawConnection() {
  drawLink(studio.link, studio.late);
  drawStale(studio);
  alarm.draw();
}

setInterval(() => {
  drawConnection();
  if (!studio.tick) return;
  text($("#chip-fps b"), history.rate ? history.rate.toFixed(0) : "–");
  text($("#chip-latency b"), history.percentile(0.5).toFixed(2));
  text($("#chip-rtt b"), line.roundTrip.toFixed(0));
  plots.draw();
}, 250);

hears("header, main");
api.get("/api/health").catch((error) => toast(capital(error.message)));
