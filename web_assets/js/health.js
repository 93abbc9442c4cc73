// How the loop is doing: time per section, a sparkline, and what was dropped.

import { $, el, text } from "./ui.js";

const COLOURS = ["#5c9cff", "#f0975f", "#2ecc82", "#b18cff", "#f5b83d", "#4fd1d9", "#ff7aa8", "#9fb0c8", "#7ddf64", "#d68f5b"];
// Sums of other sections, and waiting, are not work.
const SUMS = new Set(["retarget", "inference", "total", "tick", "period", "wait", "sleep", "jitter"]);
const HISTORY = 600;
const history = [];
const means = new Map();
const fps = { count: 0, since: performance.now(), value: 0 };

export function count(tick) {
  fps.count += 1;
  const now = performance.now();
  if (now - fps.since >= 1000) {
    fps.value = (1000 * fps.count) / (now - fps.since);
    fps.count = 0;
    fps.since = now;
  }
  let total = 0;
  for (const [name, ms] of Object.entries(tick.timings_ms)) {
    if (SUMS.has(name)) continue;
    total += ms;
    means.set(name, 0.95 * (means.get(name) ?? ms) + 0.05 * ms);
  }
  history.push(total);
  if (history.length > HISTORY) history.shift();
  return total;
}

export const framesPerSecond = () => fps.value;

export function percentile(p) {
  const sorted = [...history].sort((a, b) => a - b);
  return sorted.length ? sorted[Math.min(sorted.length - 1, Math.floor(p * sorted.length))] : 0;
}

export function drawHealth(counters) {
  const sections = $("#sections");
  const names = [...means.keys()];
  if (sections.dataset.names !== names.join()) {
    sections.dataset.names = names.join();
    const coloured = (tag, i) => { const node = el(tag); node.style.setProperty("--c", COLOURS[i % COLOURS.length]); return node; };
    sections.replaceChildren(
      el("div", { class: "stack", title: "Where the time of a tick goes" }, ...names.map((_, i) => coloured("i", i))),
      el("div", { class: "legend" }, ...names.map((name, i) => el("div", {}, coloured("i", i), name, el("b", {}, "")))),
    );
  }
  names.forEach((name, i) => {
    $(".stack", sections).children[i].style.flex = `${means.get(name)} 0 0`;
    text($("b", $(".legend", sections).children[i]), means.get(name).toFixed(2));
  });
  text($("#health-now"), `p50 ${percentile(0.5).toFixed(2)} · p99 ${percentile(0.99).toFixed(2)} ms`);
  spark($("#spark"));
  const list = $("#counters");
  const shown = ["frames", "rejected", "stale", "clipped", "late"];
  if (!list.children.length)
    list.append(...shown.map((name) => el("div", { id: `count-${name}` }, el("dt", {}, name), el("dd", {}, "0"))));
  for (const name of shown) {
    const cell = $(`#count-${name}`);
    text($("dd", cell), (counters[name] ?? 0).toLocaleString("en"));
    cell.classList.toggle("bad", name !== "frames" && name !== "clipped" && counters[name] > 0);
  }
}

function spark(canvas) {
  const ratio = devicePixelRatio || 1, w = canvas.clientWidth, h = 56;
  if (!w) return;
  if (canvas.width !== Math.round(w * ratio)) { canvas.width = Math.round(w * ratio); canvas.height = h * ratio; }
  const context = canvas.getContext("2d"), style = getComputedStyle(canvas);
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, w, h);
  const top = Math.max(2, percentile(0.995) * 1.25);
  const y = (ms) => h - 4 - (h - 10) * Math.min(1, ms / top);
  context.beginPath();
  history.forEach((ms, i) => context.lineTo((i / (HISTORY - 1)) * w, y(ms)));
  context.strokeStyle = style.getPropertyValue("--accent");
  context.lineWidth = 1.4;
  context.stroke();
  context.fillStyle = style.getPropertyValue("--muted");
  context.font = "11px system-ui, sans-serif";
  context.textAlign = "left";
  context.fillText(`${top.toFixed(1)} ms`, 2, 11);
  context.textAlign = "right";
  context.fillText("a tick, last 20 s", w - 2, 11);
}
