// The page of a camera: the person in front of it, what is seen of them, and the way to drive.

import { Api } from "./net.js";
import { $, $button, $canvas, $input, $select, el, text } from "./dom.js";
import { Camera } from "./webcam-device.js";
import { Driving } from "./webcam-drive.js";
import { advice, confidence } from "./webcam-framing.js";
import { PoseModel } from "./webcam-model.js";
import { painter } from "./webcam-paint.js";
import { typing } from "./keys.js";
import { capital } from "./words.js";

/** @import { Seen } from "./webcam-framing.js" */

const RATE_OVER = 2000; // ms
const KEPT = ["model", "delegate", "height"];

const video = /** @type {HTMLVideoElement} */ ($("#video"));
const paint = painter($canvas("#overlay"));
/** @type {{ seen: Seen | null, hint: string, times: number[], age: number }} */
const now = { seen: null, hint: "", times: [], age: 0 };

const driving = new Driving(new Api(), say);
const model = new PoseModel({
  seen: (seen) => {
    now.seen = seen;
    now.hint = advice(seen);
    now.age = performance.now() - 1000 * seen.t;
    now.times.push(performance.now());
    while (now.times[0] < performance.now() - RATE_OVER) now.times.shift();
    driving.push(seen, !now.hint);
    draw();
  },
  ready: (delegate) => {
    $("#computed").dataset.delegate = delegate;
    say("");
  },
  trouble: say,
});
const camera = new Camera(video, {
  frame: (t) => {
    if (model.idle) model.look(video, t);
  },
  lost: (line) => off(line),
});
Object.assign(window, { a1camera: { camera, driving, model, now } }); // for tests and the curious

/** @param {string} line "" for nothing */
function say(line) {
  text($("#said"), line);
  $("#said").hidden = !line;
}

/** Open the chosen camera and model, or say why not. */
async function on() {
  $button("#start").disabled = true;
  try {
    await camera.open($select("#device").value, Number($select("#height").value));
    say("Loading the pose model…");
    model.open($select("#model").value, $select("#delegate").value);
    await listCameras();
  } catch (error) {
    off(/** @type {Error} */ (error).message);
  }
  $button("#start").disabled = false;
  draw();
}

/** Nothing is looked at any more. @param {string} line */
function off(line) {
  camera.close();
  model.close();
  driving.end().catch((error) => say(capital(error.message)));
  Object.assign(now, { seen: null, hint: "", times: [] });
  say(line);
  draw();
}

async function listCameras() {
  const select = $select("#device");
  const found = await camera.list();
  select.replaceChildren(
    ...found.map(({ deviceId, label }, k) =>
      el("option", { value: deviceId }, label || `Camera ${k + 1}`),
    ),
  );
  select.value = camera.id;
}

function draw() {
  const { seen, hint, times } = now;
  document.body.dataset.camera = camera.on ? "on" : "off";
  text($("#start"), camera.on ? "Camera off" : "Camera on");
  const drives = driving.stage !== "off";
  $button("#drive").disabled = !camera.on;
  $("#drive").setAttribute("aria-pressed", String(drives));
  text($("#drive"), drives ? "Stop driving" : "Drive the robot");
  text($("#hint"), camera.on ? hint : "");
  text($("#line"), driving.line);
  const { frames, why } = driving.refused;
  text($("#refused"), frames ? `${frames} refused: ${why}` : "");
  text($("#fps"), camera.on ? `${(times.length / (RATE_OVER / 1000)).toFixed(0)} fps` : "");
  text($("#sure"), seen?.world ? `${Math.round(100 * confidence(seen.landmarks))} % sure` : "");
  text($("#age"), seen ? `${now.age.toFixed(0)} ms old` : "");
  paint(video, {
    landmarks: camera.on ? (seen?.landmarks ?? null) : null,
    stand: camera.on && Boolean(hint),
    filled: driving.stage === "quiet" ? driving.filled : null,
  });
}

/** What the user asked for; why, if it is refused. @param {() => Promise<void>} action */
const attempt = (action) => () =>
  action()
    .catch((error) => say(capital(error.message)))
    .then(draw);
const drive = attempt(async () => {
  if (driving.stage !== "off") return driving.end();
  say("");
  await driving.begin();
});
const stop = attempt(() => driving.stop());

$("#start").addEventListener("click", () => (camera.on ? off("") : on()));
$("#drive").addEventListener("click", drive);
$("#stop").addEventListener("click", stop);
for (const id of ["device", ...KEPT])
  $(`#${id}`).addEventListener("change", () => {
    if (KEPT.includes(id)) localStorage.setItem(`camera-${id}`, $select(`#${id}`).value);
    if (camera.on) on();
  });
for (const id of KEPT)
  $select(`#${id}`).value = localStorage.getItem(`camera-${id}`) ?? $select(`#${id}`).value;
const mirror = $input("#mirror");
mirror.checked = localStorage.getItem("camera-mirror") !== "no";
const turn = () => (document.body.dataset.mirror = mirror.checked ? "yes" : "no");
mirror.addEventListener("change", () => {
  localStorage.setItem("camera-mirror", mirror.checked ? "yes" : "no");
  turn();
});
turn();
// Escape stops wherever the focus is; so does Space where it means nothing else.
window.addEventListener(
  "keydown",
  (event) => {
    const focus = /** @type {HTMLElement | null} */ (event.target);
    if (
      event.key !== "Escape" &&
      (event.key !== " " || typing(focus) || focus?.closest("button,select,input"))
    )
      return;
    event.preventDefault();
    if (!event.repeat) stop();
  },
  true,
);
document.addEventListener("visibilitychange", () => {
  if (driving.stage !== "off")
    say(document.hidden ? "" : "This page was in the background, where a camera is not read");
});
navigator.mediaDevices?.addEventListener("devicechange", () => {
  if (camera.on) listCameras();
});
document.documentElement.dataset.theme =
  localStorage.getItem("theme") ??
  (matchMedia("(prefers-color-scheme: light)").matches ? "light" : "dark");
document.body.classList.toggle("small", new URLSearchParams(location.search).has("panel"));
setInterval(draw, 500);
draw();
