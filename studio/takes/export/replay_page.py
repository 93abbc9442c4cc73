"""The page around a replay: a canvas, a scrubber and a hundred lines of script, all in one text."""

PAGE = """<!doctype html>
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta http-equiv="Content-Security-Policy"
  content="default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'">
<title>{{title}}</title>
<style>
  html, body { margin: 0; height: 100%; background: #12151b; color: #dfe5ee;
    font: 14px/1.4 system-ui, sans-serif }
  body { display: flex; flex-direction: column }
  header { padding: 10px 16px; display: flex; gap: 16px; align-items: baseline }
  header b { font-size: 16px }
  header span { color: #8b97a8 }
  canvas { flex: 1; min-height: 0; width: 100%; touch-action: none; cursor: grab }
  footer { display: flex; gap: 12px; align-items: center; padding: 10px 16px; background: #1a1f28 }
  input[type=range] { flex: 1; accent-color: #5aa9ff }
  button, select { background: #2a3240; color: inherit; border: 0; border-radius: 6px;
    padding: 6px 14px; font: inherit; cursor: pointer }
  output { font-variant-numeric: tabular-nums; min-width: 9em; text-align: right }
</style>
<header><b id="label"></b><span id="state"></span>
  <span style="margin-left:auto">drag turns the view, space plays, arrows step</span></header>
<canvas id="view" aria-label="replay of both figures"></canvas>
<footer>
  <button id="play" aria-label="play or pause">Pause</button>
  <input id="scrub" type="range" min="0" value="0" step="1" aria-label="time">
  <select id="speed" aria-label="speed"><option value="0.25">¼×</option>
    <option value="0.5">½×</option><option value="1" selected>1×</option>
    <option value="2">2×</option><option value="4">4×</option></select>
  <output id="time"></output>
</footer>
<script id="take" type="application/json">{{data}}</script>
<script>
"use strict";
const take = JSON.parse(document.getElementById("take").textContent);
const el = id => document.getElementById(id);
const colors = { person: "#ffb454", shown: "#5aa9ff", robot: "#7bd88f" };
for (const figure of take.figures) {
  const raw = atob(figure.data), view = new DataView(new ArrayBuffer(raw.length));
  for (let i = 0; i < raw.length; i++) view.setUint8(i, raw.charCodeAt(i));
  figure.mm = i => view.getInt16(2 * i, true) / 1000;
}
const frames = take.states.length;
const canvas = el("view"), pen = canvas.getContext("2d");
let frame = 0, playing = true, last = null, yaw = 0.6, pitch = 0.25, dirty = true;
el("label").textContent = take.label || take.name;
el("scrub").max = frames - 1;

function project(x, y, z, scale, cx, cy) {
  // Seen from ahead and to one side; what is further away is higher on the screen.
  const c = Math.cos(yaw), s = Math.sin(yaw), a = c * x - s * y, depth = -s * x - c * y;
  const up = Math.cos(pitch) * z + Math.sin(pitch) * depth;
  return [cx - scale * a, cy - scale * up];
}
function size(figure) { return figure.title === "person" ? 2.1 : 1.15; }
function draw() {
  const ratio = window.devicePixelRatio || 1;
  const w = canvas.clientWidth, h = canvas.clientHeight;
  if (canvas.width !== Math.round(w * ratio) || canvas.height !== Math.round(h * ratio)) {
    canvas.width = Math.round(w * ratio); canvas.height = Math.round(h * ratio);
  }
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.clearRect(0, 0, w, h);
  const now = Math.min(frames - 1, Math.floor(frame)), share = w / take.figures.length;
  take.figures.forEach((figure, n) => {
    const at = i => 3 * (now * figure.points + i);
    const scale = Math.min(share * 0.8, h * 0.8) / size(figure);
    const cx = share * (n + 0.5), cy = h * 0.86;
    // The floor stays under the figure: what walks away would leave the picture.
    let mx = 0, my = 0;
    for (let i = 0; i < figure.points; i++) {
      mx += figure.mm(at(i)) / figure.points; my += figure.mm(at(i) + 1) / figure.points;
    }
    pen.lineWidth = 1; pen.strokeStyle = "#2c3442";
    const reach = size(figure) / 2, gap = reach / 3;
    for (let k = -3; k <= 3; k++) {
      const fx = k * gap - (mx % gap), fy = k * gap - (my % gap);
      line(project(fx, -reach, 0, scale, cx, cy), project(fx, reach, 0, scale, cx, cy));
      line(project(-reach, fy, 0, scale, cx, cy), project(reach, fy, 0, scale, cx, cy));
    }
    let low = 0;
    if (figure.title === "person") {
      low = Infinity;
      for (let i = 0; i < figure.points; i++) low = Math.min(low, figure.mm(at(i) + 2));
    }
    const points = [];
    for (let i = 0; i < figure.points; i++) {
      const x = figure.mm(at(i)) - mx, y = figure.mm(at(i) + 1) - my;
      points.push(project(x, y, figure.mm(at(i) + 2) - low, scale, cx, cy));
    }
    pen.lineWidth = figure.title === "person" ? 5 : 6; pen.lineCap = "round";
    pen.strokeStyle = colors[figure.title] || "#dfe5ee";
    for (const [a, b] of figure.lines) line(points[a], points[b]);
    pen.fillStyle = "#8b97a8"; pen.textAlign = "center";
    pen.fillText(figure.title, cx, h - 12);
  });
  el("state").textContent = take.states[now];
  el("scrub").value = now;
  el("time").textContent =
    (now / take.fps).toFixed(2) + " / " + (frames / take.fps).toFixed(2) + " s";
}
function line(a, b) {
  pen.beginPath(); pen.moveTo(a[0], a[1]); pen.lineTo(b[0], b[1]); pen.stroke();
}
function tick(ms) {
  if (playing && last !== null) {
    frame += (ms - last) / 1000 * take.fps * Number(el("speed").value);
    if (frame >= frames) frame = 0;
    dirty = true;
  }
  last = ms;
  if (dirty) { dirty = false; draw(); }
  requestAnimationFrame(tick);
}
function play(on) { playing = on; el("play").textContent = on ? "Pause" : "Play"; }
function go(to) { frame = Math.max(0, Math.min(frames - 1, to)); play(false); dirty = true; }
el("play").onclick = () => play(!playing);
el("scrub").oninput = event => go(Number(event.target.value));
addEventListener("keydown", event => {
  if (event.key === " ") { event.preventDefault(); play(!playing); }
  if (event.key === "ArrowRight") go(Math.floor(frame) + 1);
  if (event.key === "ArrowLeft") go(Math.floor(frame) - 1);
});
canvas.onpointermove = event => {
  if (!event.buttons) return;
  yaw += event.movementX * 0.01;
  pitch = Math.max(-0.1, Math.min(1.5, pitch + event.movementY * 0.01));
  dirty = true;
};
addEventListener("resize", () => { dirty = true; });
requestAnimationFrame(tick);
</script>
</html>
"""
