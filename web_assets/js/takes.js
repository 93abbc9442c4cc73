// Recording, and the list of takes.

import { $, attempt, capital, el, search, text, toast } from "./ui.js";
import { call, get, post } from "./net.js";
import { openReview } from "./review.js";

const ROWS = 60;
let recording = null, trouble = null, takes = [];

export function startTakes(app) {
  $("#record").addEventListener("click", () => attempt(async () => {
    if (recording) {
      const take = await post("/api/takes/stop");
      toast(`Take ${take.name}: ${take.ticks} ticks`, "good");
    } else {
      await post("/api/takes/start", { label: $("#label").value.trim() });
    }
    refresh();
  }));
  const seek = (body) => attempt(() => post("/api/seek", body));
  $("#replay-play").addEventListener("click", () => seek({ playing: !app.state.replay?.playing }));
  $("#replay-at").addEventListener("input", (event) => seek({ t: +event.target.value, playing: false }));
  $("#replay-speed").addEventListener("change", (event) => seek({ speed: +event.target.value }));
  $("#takes-find").addEventListener("input", list);
  refresh();
}

// As it was: both figures and the person, from the tape.
async function replay(name) {
  await post("/api/source", { source: `take:${name}` });
  await post("/api/mode", { mode: "replay" });
}

async function refresh() {
  try {
    const data = await get("/api/takes");
    takes = (Array.isArray(data) ? data : data.takes) ?? [];
  } catch { return; }
  list();
}

function list() {
  const { rows, line } = search(takes, $("#takes-find").value, ROWS);
  $("#takes-find").hidden = !takes.length;
  text($("#takes-shown"), line);
  $("#takes-shown").hidden = !line;
  if (!takes.length) {
    $("#takes").replaceChildren(el("li", { class: "empty" }, "No takes yet. Recording keeps you and the robot together."));
    return;
  }
  $("#takes").replaceChildren(...rows.map((take) => el("li", {},
    el("div", { class: "name", title: take.name }, el("b", {}, take.label || take.name),
      el("span", {}, `${(take.seconds ?? 0).toFixed(1)} s · ${take.ticks ?? 0} ticks`)),
    el("button", { title: "Let the recorded person drive the robot again", onclick: () =>
      attempt(() => post("/api/source", { source: `take:${take.name}` })) }, "Drive"),
    el("button", { title: "Scrub, trim, align, judge", onclick: () => openReview(take.name) }, "Review"),
    el("button", { title: "Show the take again as it was", onclick: () => attempt(() => replay(take.name)) }, "Replay"),
    el("button", { title: "Delete (to a bin)", "aria-label": `Delete ${take.name}`, onclick: () =>
      attempt(async () => { await call("DELETE", `/api/takes/${take.name}`); refresh(); }) }, "✕"),
  )));
}

function drawReplay(replaying) {
  $("#replay").hidden = !replaying;
  if (!replaying) return;
  const at = $("#replay-at");
  at.max = replaying.seconds;
  if (document.activeElement !== at || replaying.playing) at.value = replaying.t;
  text($("#replay-play"), replaying.playing ? "❚❚" : "▶");
  text($("#replay-time"), `${replaying.t.toFixed(1)} / ${replaying.seconds.toFixed(1)} s`);
  $("#replay-speed").value = String(replaying.speed);
}

export function drawTakes(state) {
  drawReplay(state.mode === "replay" ? state.replay : null);
  const now = state.recording ?? null;
  if (recording && !now) refresh();
  recording = now;
  const button = $("#record");
  button.setAttribute("aria-pressed", Boolean(now));
  text($("b", button), now ? "Stop" : "Record");
  $("#chip-rec").hidden = !now;
  if (now) text($("#chip-rec b"), `${((now.ticks ?? 0) / 30).toFixed(0)} s`);
  text($("#record-now"), now ? now.name : "");
  const error = state.recording_error ?? null;
  if (error && error !== trouble) toast(capital(error));
  trouble = error;
  text($("#record-error"), capital(error ?? ""));
  $("#record-error").hidden = !error;
}
