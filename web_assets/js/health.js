// How the loop is doing: time per section, a sparkline, and what was dropped.

import { $, $canvas, el, setStyle, text } from "./dom.js";
import { HISTORY } from "./history.js";

/** @import { TickHistory } from "./history.js" */

const COLOURS = [
  "#5c9cff",
  "#f0975f",
  "#2ecc82",
  "#b18cff",
  "#f5b83d",
  "#4fd1d9",
  "#ff7aa8",
  "#9fb0c8",
  "#7ddf64",
  "#d68f5b",
];
const COUNTERS = ["frames", "rejected", "stale", "clipped", "late"];
const HARMLESS = ["frames", "clipped"];
const HEIGHT = 56;

/** @param {number} i */
const coloured = (i) => el("i", { style: { "--c": COLOURS[i % COLOURS.length] } });

/** @param {TickHistory} history @param {Record<string, number>} counters */
export function drawHealth(history, counters) {
  drawSections(history.sections);
  const [p50, p99] = [0.5, 0.99].map((p) => history.percentile(p).toFixed(2));
  text($("#health-now"), `p50 ${p50} · p99 ${p99} ms`);
  drawSpark($canvas("#spark"), history);
  const list = $("#counters");
  if (!list.children.length)
    list.append(
      ...COUNTERS.map((name) =>
        el("div", { id: `count-${name}` }, el("dt", {}, name), el("dd", {}, "0")),
      ),
    );
  for (const name of COUNTERS) {
    const cell = $(`#count-${name}`);
    const count = counters[name] ?? 0;
    text($("dd", cell), count.toLocaleString("en"));
    cell.classList.toggle("bad", count > 0 && !HARMLESS.includes(name));
  }
}

/** @param {Map<string, number>} sections */
function drawSections(sections) {
  const box = $("#sections");
  const names = [...sections.keys()];
  if (box.dataset.names !== names.join()) {
    box.dataset.names = names.join();
    const bars = names.map((name, i) => el("div", {}, coloured(i), name, el("b")));
    box.replaceChildren(
      el(
        "div",
        { class: "stack", title: "Where the time of a tick goes" },
        ...names.map((_, i) => coloured(i)),
      ),
      el("div", { class: "legend" }, ...bars),
    );
  }
  const stack = $(".stack", box).children;
  const legend = $(".legend", box).children;
  [...sections.values()].forEach((ms, i) => {
    setStyle(/** @type {HTMLElement} */ (stack[i]), { flex: `${ms} 0 0` });
    text($("b", legend[i]), ms.toFixed(2));
  });
}

/** @param {HTMLCanvasElement} canvas @param {TickHistory} history */
function drawSpark(canvas, history) {
  const ratio = devicePixelRatio || 1;
  const width = canvas.clientWidth;
  const pen = canvas.getContext("2d");
  if (!width || !pen) return;
  if (canvas.width !== Math.round(width * ratio)) {
    canvas.width = Math.round(width * ratio);
    canvas.height = HEIGHT * ratio;
  }
  const style = getComputedStyle(canvas);
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.clearRect(0, 0, width, HEIGHT);
  const top = Math.max(2, history.percentile(0.995) * 1.25);
  pen.beginPath();
  history.total.forEach((ms, i) =>
    pen.lineTo((i / (HISTORY - 1)) * width, HEIGHT - 4 - (HEIGHT - 10) * Math.min(1, ms / top)),
  );
  pen.strokeStyle = style.getPropertyValue("--accent");
  pen.lineWidth = 1.4;
  pen.stroke();
  pen.fillStyle = style.getPropertyValue("--muted");
  pen.font = "11px system-ui, sans-serif";
  pen.textAlign = "left";
  pen.fillText(`${top.toFixed(1)} ms`, 2, 11);
  pen.textAlign = "right";
  pen.fillText("a tick, last 20 s", width - 2, 11);
}
