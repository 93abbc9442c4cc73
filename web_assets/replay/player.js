// Plays a take in a page of its own, from a file, without a server or a network.

import { Figures } from "./figures.js";
import { Painter } from "./painter.js";
import { applied, camera } from "./space.js";

/** @import { Take } from "./figures.js" */

const FOV = 0.5; // rad
const WIDE = 2.9; // m that are to be seen across
const STEPS = { ArrowRight: 1, ArrowLeft: -1 };

/** @param {string} id */
const node = (id) => /** @type {HTMLElement} */ (document.getElementById(id));
/** @param {string} id */
const field = (id) => /** @type {HTMLInputElement} */ (node(id));

class Player {
  #playing = !matchMedia("(prefers-reduced-motion: reduce)").matches;
  #frame = 0;
  #yaw = -0.3;
  #pitch = 0.17;
  #near = 1;
  #dirty = true;
  /** ms of the last picture. @type {number | null} */
  #last = null;

  /** @param {Take} take @param {Painter} painter */
  constructor(take, painter) {
    this.take = take;
    this.painter = painter;
    this.figures = new Figures(take, painter);
    this.captions = this.figures.titles.map((title) => {
      const caption = Object.assign(document.createElement("div"), { textContent: title });
      caption.className = "caption";
      node("stage").append(caption);
      return caption;
    });
    node("label").textContent = take.label || take.name;
    field("scrub").max = String(this.figures.frames - 1);
    this.#play(this.#playing);
    node("play").addEventListener("click", () => this.#play(!this.#playing));
    field("scrub").addEventListener("input", () => this.#go(Number(field("scrub").value)));
    addEventListener("keydown", (event) => this.#key(event));
    this.#turnable();
    new ResizeObserver(() => {
      painter.fit();
      this.#dirty = true;
    }).observe(painter.canvas);
    matchMedia("(prefers-color-scheme: light)").addEventListener("change", () => {
      this.#dirty = true;
    });
    requestAnimationFrame((ms) => this.#tick(ms));
  }

  /** By the pointer, and two fingers or the wheel for nearer and further. */
  #turnable() {
    const { canvas } = this.painter;
    canvas.addEventListener("pointermove", (event) => {
      if (!event.buttons) return;
      this.#yaw -= event.movementX * 0.01;
      this.#pitch = Math.max(0.02, Math.min(1.5, this.#pitch + event.movementY * 0.01));
      this.#dirty = true;
    });
    canvas.addEventListener("pointerdown", (event) => canvas.setPointerCapture(event.pointerId));
    canvas.addEventListener(
      "wheel",
      (event) => {
        event.preventDefault();
        this.#near = Math.max(0.35, Math.min(2.5, this.#near * Math.exp(event.deltaY * 0.001)));
        this.#dirty = true;
      },
      { passive: false },
    );
  }

  /** @param {KeyboardEvent} event */
  #key(event) {
    const focus = /** @type {HTMLElement} */ (event.target);
    const step = STEPS[/** @type {keyof typeof STEPS} */ (event.key)];
    if (event.key === " " && focus.tagName !== "BUTTON") {
      event.preventDefault();
      this.#play(!this.#playing);
    } else if (step && focus.tagName !== "SELECT") {
      event.preventDefault();
      this.#go(Math.floor(this.#frame) + step);
    }
  }

  /** @param {boolean} on */
  #play(on) {
    this.#playing = on;
    node("play").textContent = on ? "Pause" : "Play";
  }

  /** @param {number} frame */
  #go(frame) {
    this.#frame = Math.max(0, Math.min(this.figures.frames - 1, frame));
    this.#play(false);
    this.#dirty = true;
  }

  /** @param {number} ms */
  #tick(ms) {
    if (this.#playing && this.#last !== null) {
      const speed = Number(field("speed").value);
      this.#frame += ((ms - this.#last) / 1000) * this.take.fps * speed;
      if (this.#frame >= this.figures.frames) this.#frame = 0;
      this.#dirty = true;
    }
    this.#last = ms;
    if (this.#dirty) this.#draw();
    this.#dirty = false;
    requestAnimationFrame((next) => this.#tick(next));
  }

  #draw() {
    const now = Math.min(this.figures.frames - 1, Math.floor(this.#frame));
    const { canvas } = this.painter;
    const aspect = canvas.width / canvas.height;
    // As far as shows all three in a window of any shape.
    const far = (this.#near * Math.max(1.5, WIDE / aspect)) / (2 * Math.tan(FOV / 2));
    const view = camera([0, 0, 0.42], this.#yaw, this.#pitch, far, FOV, aspect);
    const light = matchMedia("(prefers-color-scheme: light)").matches;
    const line = light ? [0.42, 0.48, 0.58] : [0.45, 0.52, 0.64];
    const shown = this.figures.at(now);
    this.painter.draw(view, shown.flat(), this.figures.passed(now), line);
    this.figures.tops(shown).forEach((point, i) => {
      const [x, y, , w] = applied(view, point);
      const [left, top] = [50 + (50 * x) / w, 50 - (50 * y) / w];
      this.captions[i].style.left = `${left}%`;
      this.captions[i].style.top = `${top}%`;
    });
    node("state").textContent = this.take.states[now];
    field("scrub").value = String(now);
    const seconds = (/** @type {number} */ frames) => (frames / this.take.fps).toFixed(2);
    node("time").textContent = `${seconds(now)} / ${seconds(this.figures.frames)} s`;
  }
}

const painter = Painter.on(/** @type {HTMLCanvasElement} */ (node("view")));
if (painter) new Player(JSON.parse(node("take").textContent ?? ""), painter);
else node("none").hidden = false;
