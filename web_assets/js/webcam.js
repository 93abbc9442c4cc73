// The page of a camera: the person in front of it, what is seen of them, and the way to drive.

import { Api } from "./net.js";
import { $, $button, $canvas, $input, $select, el, hears, text } from "./dom.js";
import { LatencyDoor } from "./latency-door.js";
import { Camera } from "./webcam-device.js";
import { Driving } from "./webcam-drive.js";
import { advice, confidence } from "./webcam-framing.js";
import { PoseModel } from "./webcam-model.js";
import { painter } from "./webcam-paint.js";
import { typing } from "./keys.js";
import { capital } from "./words.js";

/** @import { Headset } from "./headset.js" */
/** @import { Seen } from "./webcam-framing.js" */

const RATE_OVER = 2000; // ms
const KEPT = ["model", "delegate", "height"];

/** What the page shows, and what its buttons do. */
class CameraPage {
  /** The person as the model saw them last, and what to change about how they stand. */
  /** @type {Seen | null} */
  seen = null;
  hint = "";
  /** ms from the picture to its being seen. */
  age = 0;
  /** When the latest pictures were seen, ms. @type {number[]} */
  #times = [];
  #video = /** @type {HTMLVideoElement} */ ($("#video"));
  #paint = painter($canvas("#overlay"));
  api = new Api();
  driving = new Driving(this.api, (line) => this.say(line));
  /** Loaded when it is put on. @type {Headset | null} */
  headset = null;
  model = new PoseModel({
    seen: (seen) => this.#look(seen),
    ready: (delegate) => {
      $("#computed").dataset.delegate = delegate;
      this.say("");
    },
    trouble: (line) => this.say(line),
  });
  camera = new Camera(this.#video, {
    frame: (t, came) => {
      if (!this.model.idle) return;
      this.model.look(this.#video, t);
      this.latency.meter?.looked(this.#video, t, came);
    },
    lost: (line) => this.off(line),
  });
  latency = new LatencyDoor($("#latency"), this.camera);

  /** @param {Seen} seen */
  #look(seen) {
    const now = performance.now();
    this.seen = seen;
    this.hint = advice(seen);
    this.age = now - 1000 * seen.t;
    this.#times = [...this.#times, now].filter((t) => t >= now - RATE_OVER);
    this.driving.push(seen, !this.hint);
    this.latency.meter?.sent(seen);
    this.draw();
  }

  /** @param {string} line "" for nothing */
  say(line) {
    text($("#said"), line);
    $("#said").hidden = !line;
  }

  /** Open the chosen camera and model, or say why not. */
  async on() {
    $button("#start").disabled = true;
    try {
      await this.camera.open($select("#device").value, Number($select("#height").value));
      this.say("Loading the pose model…");
      this.model.open($select("#model").value, $select("#delegate").value);
      await this.listCameras();
    } catch (error) {
      this.off(/** @type {Error} */ (error).message);
    }
    $button("#start").disabled = false;
    this.draw();
  }

  /** Nothing is looked at any more. @param {string} line */
  off(line) {
    this.camera.close();
    this.model.close();
    this.driving.end().catch((error) => this.say(capital(error.message)));
    this.seen = null;
    this.hint = "";
    this.#times = [];
    this.say(line);
    this.draw();
  }

  async listCameras() {
    const select = $select("#device");
    const found = await this.camera.list();
    select.replaceChildren(
      ...found.map(({ deviceId, label }, k) =>
        el("option", { value: deviceId }, label || `Camera ${k + 1}`),
      ),
    );
    select.value = this.camera.id;
  }

  /** What drives, or would: the headset while it is on. */
  get driver() {
    return this.headset?.on ? this.headset.driving : this.driving;
  }

  draw() {
    const { seen, hint, camera, driver: driving } = this;
    const on = Boolean(this.headset?.on);
    $("#headset").setAttribute("aria-pressed", String(on));
    text($("#headset"), on ? "Headset off" : "Headset on");
    document.body.dataset.camera = camera.on ? "on" : "off";
    text($("#start"), camera.on ? "Camera off" : "Camera on");
    const drives = driving.stage !== "off";
    $button("#drive").disabled = !camera.on && !on;
    $("#drive").setAttribute("aria-pressed", String(drives));
    text($("#drive"), drives ? "Stop driving" : "Drive the robot");
    text($("#hint"), camera.on ? hint : "");
    text($("#line"), driving.line);
    const { frames, why } = driving.refused;
    text($("#refused"), frames ? `${frames} refused: ${why}` : "");
    const rate = this.#times.length / (RATE_OVER / 1000);
    text($("#fps"), camera.on ? `${rate.toFixed(0)} fps` : "");
    text($("#sure"), seen?.world ? `${Math.round(100 * confidence(seen.landmarks))} % sure` : "");
    text($("#age"), seen ? `${this.age.toFixed(0)} ms old${driving.onward}` : "");
    this.#paint(this.#video, {
      landmarks: camera.on ? (seen?.landmarks ?? null) : null,
      stand: camera.on && Boolean(hint),
      filled: driving.stage === "quiet" ? driving.filled : null,
    });
  }

  /** What the user asked for; why, if it is refused. @param {() => Promise<void>} action */
  async #attempt(action) {
    await action().catch((error) => this.say(capital(error.message)));
    this.draw();
  }

  /** Drive, or stop driving. */
  drive() {
    return this.#attempt(async () => {
      if (this.driver.stage !== "off") return this.driver.end();
      this.say("");
      await this.driver.begin();
    });
  }

  stop() {
    return this.#attempt(() => this.driver.stop());
  }

  /** Put the headset on, or take it off. */
  wear() {
    return this.#attempt(async () => {
      if (this.headset?.on) return this.headset.end();
      if (this.camera.on) this.off("");
      this.say("");
      const { Headset } = await import("./headset.js");
      const hooks = {
        say: (/** @type {string} */ line) => this.say(line),
        changed: () => this.draw(),
      };
      this.headset ??= new Headset(this.api, hooks);
      await this.headset.begin();
    });
  }

  /** Whether there is a headset, or what would bring one here. */
  async lookForHeadset() {
    const modes = /** @type {const} */ (["immersive-ar", "immersive-vr"]);
    const found = await Promise.all(
      modes.map((mode) => navigator.xr?.isSessionSupported(mode).catch(() => false)),
    );
    $("#headset").hidden = !found.some(Boolean);
    const how = window.isSecureContext
      ? "open this page in its own browser, as a phone is invited (serve with --phone)"
      : "open this page by https or as http://localhost";
    text($("#headset-why"), found.some(Boolean) ? "" : `A headset drives, too: ${how}.`);
  }
}

const page = new CameraPage();
Object.assign(window, { a1camera: page }); // for tests and the curious

$("#start").addEventListener("click", () => (page.camera.on ? page.off("") : page.on()));
$("#drive").addEventListener("click", () => page.drive());
$("#stop").addEventListener("click", () => page.stop());
$("#headset").addEventListener("click", () => page.wear());
navigator.xr?.addEventListener("devicechange", () => page.lookForHeadset());
for (const id of ["device", ...KEPT])
  $(`#${id}`).addEventListener("change", () => {
    if (KEPT.includes(id)) localStorage.setItem(`camera-${id}`, $select(`#${id}`).value);
    if (page.camera.on) page.on();
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
    if (!event.repeat) page.stop();
  },
  true,
);
document.addEventListener("visibilitychange", () => {
  if (page.driving.stage !== "off")
    page.say(document.hidden ? "" : "This page was in the background, where a camera is not read");
});
navigator.mediaDevices?.addEventListener("devicechange", () => {
  if (page.camera.on) page.listCameras();
});
document.documentElement.dataset.theme =
  localStorage.getItem("theme") ??
  (matchMedia("(prefers-color-scheme: light)").matches ? "light" : "dark");
document.body.classList.toggle("small", new URLSearchParams(location.search).has("panel"));
setInterval(() => page.draw(), 500);
page.draw();
page.lookForHeadset();
hears("main, footer");
