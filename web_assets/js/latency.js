// How late the robot is, by section: from a camera's frame to the control period made of it, which
// the studio echoes, and to the screen. All by this page's clock but for what the studio says that
// it took itself.

import { el } from "./dom.js";
import { socketUrl } from "./socket.js";
import { timeCodeReader } from "./timecode.js";

/** @import { Tick } from "../types/page.js" */
/** @import { Camera } from "./webcam-device.js" */
/** @import { Seen } from "./webcam-framing.js" */

const KEPT = 1000; // frames
const EVERY = 1000; // ms between drawings
const FILM_FPS = 30;

/** Sections of a frame's way, in their order, which together are all of it. */
export const SECTIONS = {
  camera: "camera to page",
  model: "pose model",
  page: "page, around it",
  way: "socket, both ways",
  wait: "wait for the loop",
  reference: "reference",
  physics: "physics",
  screen: "page to screen",
};

/** @typedef {keyof typeof SECTIONS} Section */
/** A frame whose way is known. total: ms, the sum of its sections. code: of its picture.
 * @typedef {Record<Section, number> & Looked & { total: number }} Row */
/** @typedef {{ code: number | null, handed: number }} Looked */
/** A frame on its way: ms on the page's clock.
 * @typedef {{ taken: number, handed: number, code: number | null, model: number, sent: number,
 *   came?: number }} OnItsWay */

/**
 * The sections of a frame's way.
 *
 * @param {OnItsWay} frame
 * @param {Tick} tick made of it
 * @param {number} came ms @param {number} shown ms
 * @returns {Row}
 */
export function sections(frame, { human, timings_ms }, came, shown) {
  const { taken, handed, code, model, sent } = frame;
  const { inference: reference = 0, physics = 0 } = timings_ms;
  const wait = human?.echo?.waited_ms ?? 0;
  return {
    camera: handed - taken,
    model,
    page: sent - handed - model,
    way: came - sent - wait - reference - physics,
    wait,
    reference,
    physics,
    screen: shown - came,
    total: shown - taken,
    code,
    handed,
  };
}

/** From a frame to its reference beside the model's own time; the socket's way back is in it. */
export const toReference = (/** @type {Row} */ row) =>
  row.camera + row.page + row.way + row.wait + row.reference;

/**
 * How much later than the promptest a film's pictures came, ms, by the numbers in them alone; the
 * film begins anew where they step back.
 *
 * @param {Looked[]} rows
 */
export function filmLate(rows) {
  /** @type {number[][]} */
  const plays = [];
  let last = Infinity;
  for (const { code, handed } of rows) {
    if (code === null) continue;
    if (code < last) plays.push([]);
    plays.at(-1)?.push(handed - (1000 * code) / FILM_FPS);
    last = code;
  }
  return plays.flatMap((lags) => lags.map((lag) => lag - Math.min(...lags)));
}

/** @param {number[]} values */
export function percentiles(values) {
  const sorted = [...values].sort((a, b) => a - b);
  const at = (/** @type {number} */ share) => {
    const place = share * (sorted.length - 1);
    const [low, high] = [sorted[Math.floor(place)], sorted[Math.ceil(place)]];
    return low + (place % 1) * (high - low);
  };
  return { p50: at(0.5), p95: at(0.95), p99: at(0.99) };
}

export class Latency {
  /** @type {Row[]} */
  rows = [];
  /** By their own time as they are sent, s. @type {Map<number, OnItsWay>} */
  #underWay = new Map();
  #read = timeCodeReader();
  #socket = new WebSocket(socketUrl("/api/ticks"));
  #timer = setInterval(() => this.#draw(), EVERY);

  /** @param {HTMLElement} place where it is shown @param {Camera} camera */
  constructor(place, camera) {
    this.place = place;
    this.camera = camera;
    this.#socket.onmessage = ({ data }) => this.#heard(performance.now(), JSON.parse(data));
    this.#draw();
  }

  close() {
    clearInterval(this.#timer);
    this.#socket.close();
    this.place.replaceChildren();
  }

  /**
   * The model looks at a picture.
   *
   * @param {HTMLVideoElement} video
   * @param {number} taken ms @param {number} handed ms, to this page
   */
  looked(video, taken, handed) {
    for (const [t] of this.#underWay) if (1000 * t < taken - 5000) this.#underWay.delete(t);
    const code = this.#read(video);
    this.#underWay.set(taken / 1000, { taken, handed, code, model: 0, sent: 0 });
  }

  /** What was seen has been sent. @param {Pick<Seen, "t" | "ms">} seen */
  sent({ t, ms }) {
    const frame = this.#underWay.get(t);
    if (frame) Object.assign(frame, { model: ms, sent: performance.now() });
  }

  /** @param {number} came ms @param {Tick} tick */
  #heard(came, tick) {
    const t = tick.human?.echo?.sent ?? NaN;
    const frame = this.#underWay.get(t);
    if (!frame?.sent) return;
    this.#underWay.delete(t);
    // A task that is posted while a picture is made runs once it was.
    requestAnimationFrame(() => {
      const { port1, port2 } = new MessageChannel();
      port1.onmessage = () => {
        this.rows.push(sections(frame, tick, came, performance.now()));
        if (this.rows.length > KEPT) this.rows.shift();
        port1.close();
      };
      port2.postMessage(null);
    });
  }

  /** Percentiles by section; null before the first frame. */
  get summary() {
    const { rows } = this;
    if (!rows.length) return null;
    const names = /** @type {Section[]} */ (Object.keys(SECTIONS));
    const late = filmLate(rows);
    return {
      frames: rows.length,
      stamped: this.camera.stamped,
      sections_ms: Object.fromEntries(
        names.map((name) => [name, percentiles(rows.map((row) => row[name]))]),
      ),
      to_reference_ms: percentiles(rows.map(toReference)),
      total_ms: percentiles(rows.map(({ total }) => total)),
      codes: late.length,
      film_late_ms: late.length ? percentiles(late) : null,
    };
  }

  #draw() {
    const { summary } = this;
    if (!summary) {
      this.place.replaceChildren(
        el("p", { class: "note" }, "Drive, and it is shown by section: milliseconds."),
      );
      return;
    }
    const row = (/** @type {string} */ name, /** @type {ReturnType<typeof percentiles>} */ p) =>
      el(
        "tr",
        {},
        el("th", { scope: "row" }, name),
        ...[p.p50, p.p95, p.p99].map((ms) => el("td", {}, ms.toFixed(1))),
      );
    const head = ["ms", "p50", "p95", "p99"].map((name) => el("th", { scope: "col" }, name));
    this.place.replaceChildren(
      el(
        "table",
        {},
        el("tr", {}, ...head),
        ...Object.entries(SECTIONS).map(([key, name]) => row(name, summary.sections_ms[key])),
        row("to it, less model", summary.to_reference_ms),
        row("all", summary.total_ms),
      ),
      el(
        "p",
        { class: "note" },
        `Of the last ${summary.frames} frames. `,
        summary.stamped ? "" : "This browser does not say when a frame was taken. ",
        "Not in it: what a monitor adds.",
      ),
    );
  }
}
