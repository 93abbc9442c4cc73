// A film of the 3-D view: what viser draws and the captions over it, to a video file.

import { $, el, toast } from "./dom.js";
import { space } from "./library-list.js";

/** @import { View } from "./view.js" */

const RATE = 30; // pictures a second, at most
const WIDEST = 1280; // pixels
const LONGEST = 600_000; // ms: it is kept in memory until it ends
const BITS = 6_000_000; // a second
/** The first that the browser writes; VP8 costs the least, and Safari has but MP4. */
const KINDS = ["video/webm;codecs=vp8", "video/webm", "video/mp4"];

/** Why no film can be made here, or "". @param {HTMLCanvasElement} canvas */
function hindrance(canvas) {
  if (!("MediaRecorder" in window) || !canvas.captureStream) return "makes no films of a page";
  return KINDS.some((kind) => MediaRecorder.isTypeSupported(kind)) ? "" : "writes no video files";
}

/** A moment as part of a file's name. @param {Date} at */
export const stamp = (at) => {
  const two = (/** @type {number} */ n) => String(n).padStart(2, "0");
  const day = [at.getFullYear(), two(at.getMonth() + 1), two(at.getDate())].join("");
  return `${day}-${[at.getHours(), at.getMinutes(), at.getSeconds()].map(two).join("")}`;
};

/** One film, from when it is made until it is stopped. */
export class Film {
  begun = performance.now();
  /** @type {Blob[]} */
  #parts = [];
  #canvas = document.createElement("canvas");
  #pen = /** @type {CanvasRenderingContext2D} */ (this.#canvas.getContext("2d"));

  /** @param {View} view @param {string} name of the file, without its kind */
  constructor(view, name) {
    const picture = view.picture;
    if (!picture) throw new Error("the 3-D view is not there yet");
    const why = hindrance(picture.canvas);
    if (why) throw new Error(`this browser ${why}: Chrome, Edge, Firefox and new Safaris do`);
    this.name = name;
    this.captions = picture.captions;
    this.frame = $("#view");
    const kind = KINDS.find((one) => MediaRecorder.isTypeSupported(one)) ?? "";
    this.ending = kind.includes("mp4") ? "mp4" : "webm";
    const { clientWidth, clientHeight } = this.frame;
    const scale = Math.min(1, WIDEST / clientWidth);
    // Encoders want even numbers.
    this.#canvas.width = 2 * Math.round((scale * clientWidth) / 2);
    this.#canvas.height = 2 * Math.round((scale * clientHeight) / 2);
    this.source = picture.canvas; // viser keeps what it drew until it draws again
    this.#paint();
    this.timer = setInterval(() => this.#paint(), 1000 / RATE);
    this.recorder = new MediaRecorder(this.#canvas.captureStream(RATE), {
      mimeType: kind,
      videoBitsPerSecond: BITS,
    });
    this.recorder.ondataavailable = ({ data }) => this.#parts.push(data);
    this.recorder.start(1000);
  }

  /** s since it began. */
  get seconds() {
    return (performance.now() - this.begun) / 1000;
  }

  get tooLong() {
    return 1000 * this.seconds > LONGEST;
  }

  #paint() {
    const pen = this.#pen;
    const { width, height } = this.#canvas;
    const style = getComputedStyle(document.documentElement);
    const color = (/** @type {string} */ name) => style.getPropertyValue(name).trim();
    const glow = pen.createRadialGradient(
      width / 2,
      0.4 * height,
      0,
      width / 2,
      height / 2,
      0.7 * width,
    );
    glow.addColorStop(0, color("--raised"));
    glow.addColorStop(1, color("--bg"));
    pen.fillStyle = glow;
    pen.fillRect(0, 0, width, height);
    pen.drawImage(this.source, 0, 0, width, height);
    const from = this.frame.getBoundingClientRect();
    const scale = width / from.width;
    pen.textAlign = "center";
    pen.font = `600 ${14 * scale}px system-ui, sans-serif`;
    for (const caption of this.captions) {
      if (caption.style.visibility !== "visible") continue;
      const box = caption.getBoundingClientRect();
      const [left, top] = [scale * (box.left - from.left), scale * (box.top - from.top)];
      const wide = scale * box.width;
      // The name alone, at the caption's upper edge: the figure is what is filmed.
      pen.globalAlpha = 0.75;
      pen.fillStyle = color("--panel");
      pen.beginPath();
      pen.roundRect(left, top, wide, 26 * scale, 9 * scale);
      pen.fill();
      pen.globalAlpha = 1;
      pen.fillStyle = color("--text");
      const words = $("b", caption).textContent ?? "";
      pen.fillText(words, left + wide / 2, top + 18 * scale, wide - 12 * scale);
    }
  }

  /** End it, and save it. */
  async stop() {
    clearInterval(this.timer);
    const ended = new Promise((done) => (this.recorder.onstop = done));
    this.recorder.stop();
    await ended;
    const blob = new Blob(this.#parts, { type: `video/${this.ending}` });
    const file = `${this.name}.${this.ending}`;
    const href = URL.createObjectURL(blob);
    el("a", { href, download: file }).click();
    setTimeout(() => URL.revokeObjectURL(href), 60_000);
    toast(`Saved ${file}: ${this.seconds.toFixed(0)} s, ${space(blob.size)}`, "good");
  }
}
