// Training from the page: what to learn from, curves while it learns, scores, and which mapper is used.

import { $, attempt, capital, el, text, toast } from "./ui.js";
import { get, post } from "./net.js";

const METHODS = [["yours", "Yours"], ["shipped", "Shipped"], ["ridge", "Ridge"], ["nearest_pair", "Nearest pair"]];
const COLOURS = { stand: "--accent", walk: "--human", sit: "--good" };
let takes = [], job = null, timer = null, seen = null, style = null;

export function startTrain() {
  $("#train-body").append(
    el("p", { class: "note", id: "train-takes" }),
    el("select", { id: "train-from", "aria-label": "Learn from" }, el("option", { value: "" }, "The takes ticked above")),
    el("div", { class: "row states", role: "group", "aria-label": "States to train" },
      ...["stand", "walk", "sit"].map((state) => el("label", { class: "tick" },
        el("input", { type: "checkbox", value: state, checked: true }), capital(state)))),
    el("div", { class: "row" },
      el("input", { type: "text", id: "train-name", maxlength: 60, placeholder: "Name (optional)", "aria-label": "Name of the mapper" }),
      el("select", { id: "train-style", "aria-label": "What walking looks like" },
        ...["march", "circles", "semantic"].map((s) => el("option", { value: s }, capital(s))))),
    el("div", { class: "row" },
      el("select", { id: "train-start", "aria-label": "Where learning starts", title: "Little data learns best from where the shipped mapper is" },
        el("option", { value: "shipped" }, "From shipped"), el("option", { value: "scratch" }, "From scratch")),
      el("input", { type: "number", id: "train-steps", min: 20, max: 100000, placeholder: "Steps", "aria-label": "Steps of learning; empty: by the amount of data", title: "Steps of learning; empty: by the amount of data" })),
    el("div", { class: "row" },
      el("button", { class: "main", id: "train-go" }, "Train"),
      el("button", { id: "train-cancel", hidden: true }, "Cancel"),
      el("span", { class: "note", id: "train-says", role: "status" })),
    el("canvas", { class: "loss", id: "loss", height: 110, hidden: true, role: "img", "aria-label": "Loss while training" }),
    el("div", { id: "train-scores" }));
  // Which mapper drives matters most while driving: its card is there in every mode.
  $("#lock").closest(".card").after(el("details", { class: "card also", id: "mapper", open: true, hidden: true },
    el("summary", {}, "Mapper", el("span", { class: "hint", id: "mapper-now" })),
    el("div", { class: "ab", id: "ab" }), el("ul", { class: "takes", id: "mappers" })));
  $("#train-go").addEventListener("click", () => attempt(train));
  $("#train-cancel").addEventListener("click", () => attempt(async () => { job = await post("/api/train/cancel"); draw(); }));
  get("/api/train").then((found) => { job = found; if (job) { draw(); watch(); } }).catch(() => {});
  $("#train-from").addEventListener("change", ready);
  refreshMappers();
  refreshVersions();
}

export function pickTakes(names) {
  takes = names;
  text($("#train-takes"), names.length ? `${names.length} take${names.length > 1 ? "s" : ""} ticked above` : "Tick takes above to learn from them");
  ready();
}

function ready() {
  $("#train-go").disabled = job?.status === "running" || !(takes.length || $("#train-from").value);
}

async function refreshVersions() {
  let found;
  try { found = await get("/api/datasets"); } catch { return; }
  const select = $("#train-from"), chosen = select.value;
  select.replaceChildren(el("option", { value: "" }, "The takes ticked above"),
    ...[...found].reverse().slice(0, 12).map((m) => el("option", { value: m.version },
      `Data set ${m.version.slice(0, 8)}: ${m.takes.length} takes, ${m.count} pairs`)));
  select.value = [...select.options].some((o) => o.value === chosen) ? chosen : "";
  select.hidden = !found.length;
}

async function train() {
  const states = [...document.querySelectorAll("#train-body .states input:checked")].map((i) => i.value);
  const version = $("#train-from").value;
  if (!states.length) { toast("Choose at least one state"); return; }
  const name = $("#train-name").value.trim().replace(/[^A-Za-z0-9_-]+/g, "-");
  job = await post("/api/train", { ...(version ? { dataset: version } : { takes }), states, style: $("#train-style").value,
    start: $("#train-start").value, steps: +$("#train-steps").value || 0, ...(name ? { name } : {}) });
  draw();
  watch();
}

function watch() {
  clearTimeout(timer);
  if (job?.status !== "running") return;
  timer = setTimeout(async () => {
    try { job = await get("/api/train"); } catch { /* the page says so elsewhere */ }
    draw();
    if (job?.status === "running") watch();
    else if (job?.status === "done") {
      toast(`${job.name} is trained in ${job.seconds.toFixed(0)} s`, "good");
      $("#train-name").value = "";
      refreshMappers();
      refreshVersions();
    }
  }, 400);
}

function draw() {
  const running = job.status === "running";
  $("#train-cancel").hidden = !running;
  ready();
  const steps = Object.entries(job.states).filter(([, s]) => s.steps).map(([state, s]) => `${state} ${Math.round((100 * s.step) / s.steps)} %`);
  text($("#train-says"), job.status === "failed" ? capital(job.why) : running ? steps.join(" · ") || "reading takes …" : job.status === "cancelled" ? "Cancelled" : `Trained ${job.name}`);
  $("#train-says").classList.toggle("error", job.status === "failed");
  $("#loss").hidden = !steps.length;
  if (steps.length) curves($("#loss"));
  const results = Object.entries(job.states).filter(([, s]) => s.result);
  $("#train-scores").replaceChildren(...(results.length ? [scores(results.map(([state, s]) => [state, s.result]))] : []));
}

// Held-out joint error: the smaller the better; the best of each row stands out.
function scores(rows) {
  return el("table", { class: "scores" },
    el("caption", {}, "Joint error on held-out motion, degrees"),
    el("thead", {}, el("tr", {}, el("th", {}, ""), ...METHODS.map(([, title]) => el("th", {}, title)))),
    el("tbody", {}, ...rows.map(([state, result]) => {
      const values = METHODS.map(([key]) => result.scores[key].joint_rmse_deg);
      return el("tr", { title: `${result.pairs} pairs; held out: ${result.held_out}; ${result.seconds} s` },
        el("th", {}, capital(state)),
        ...values.map((v, i) => el("td", { class: `${v === Math.min(...values) ? "best" : ""} ${i ? "" : "mine"}` }, v.toFixed(2))));
    })));
}

function curves(canvas) {
  const ratio = devicePixelRatio || 1, width = canvas.clientWidth, height = 110;
  canvas.width = width * ratio;
  canvas.height = height * ratio;
  const g = canvas.getContext("2d"), style = getComputedStyle(document.documentElement);
  g.setTransform(ratio, 0, 0, ratio, 0, 0);
  g.font = "11px system-ui, sans-serif";
  const all = Object.values(job.states).flatMap((s) => s.curve.map(([, loss]) => Math.log10(Math.max(loss, 1e-6))));
  const low = Math.min(...all) - 0.05, high = Math.max(...all) + 0.05;
  g.strokeStyle = style.getPropertyValue("--line");
  g.fillStyle = style.getPropertyValue("--muted");
  for (const at of [0, 0.5, 1]) {
    const y = 8 + at * (height - 24);
    g.beginPath(); g.moveTo(38, y); g.lineTo(width, y); g.stroke();
    g.fillText((10 ** (high - at * (high - low))).toPrecision(2), 2, y + 4);
  }
  let label = 46;
  for (const [state, s] of Object.entries(job.states)) {
    if (!s.curve.length) continue;
    g.strokeStyle = g.fillStyle = style.getPropertyValue(COLOURS[state] ?? "--text");
    g.lineWidth = 1.8;
    g.beginPath();
    s.curve.forEach(([step, loss], i) => {
      const x = 38 + ((width - 42) * step) / s.steps, y = 8 + ((high - Math.log10(Math.max(loss, 1e-6))) / (high - low || 1)) * (height - 24);
      if (i) g.lineTo(x, y); else g.moveTo(x, y);
    });
    g.stroke();
    g.fillText(state, label, height - 3);
    label += 44;
  }
}

async function refreshMappers() {
  let found;
  try { found = await get("/api/mappers"); } catch { return; }
  seen = null;
  $("#mapper").hidden = !found.length;
  const use = (name) => attempt(async () => { await post("/api/mapper", { name }); toast(`${capital(name)} drives the robot now`, "good"); });
  $("#mappers").replaceChildren(...[...found].reverse().map((m) => el("li", { "data-mapper": m.name },
    el("div", { class: "name", title: m.made }, el("b", {}, m.name), el("span", {}, `${m.states.join(", ")} · ${m.takes.length} takes · ${m.style}`)),
    el("button", { onclick: () => use(m.name) }, "Use"))),
    el("li", { "data-mapper": "shipped" }, el("div", { class: "name" }, el("b", {}, "Shipped"), el("span", {}, "trained on many synthetic people")), el("button", { onclick: () => use("shipped") }, "Use")));
}

export function drawTrain(state) {
  const m = state.mapper;
  if (m && style !== m.style) $("#train-style").value = style = m.style; // what is acted out now
  if (!m || seen === `${m.name}/${m.before}`) return;
  seen = `${m.name}/${m.before}`;
  text($("#mapper-now"), m.name);
  for (const li of $("#mappers").children) {
    const on = li.dataset.mapper === m.name;
    li.classList.toggle("now", on);
    const button = $("button", li);
    button.disabled = on;
    text(button, on ? "In use" : "Use");
  }
  $("#ab").replaceChildren(...(m.before ? [el("span", {}, "A/B"),
    el("button", { id: "ab-swap", title: "Use the one before; press again to return", onclick: () => attempt(() => post("/api/mapper/back")) },
      el("b", {}, m.name), " ⇄ ", m.before)] : []));
}
