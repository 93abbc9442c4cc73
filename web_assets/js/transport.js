// The bar below the view of a source with a timeline: play, pause, seek, step, loop, speed, again.

import { $, $button, $input, $select, attempt, showIcon, text } from "./dom.js";
import { rarely } from "./rarely.js";

/** @import { Move, Played, State } from "../types/page.js" */
/** @import { Entry } from "./palette.js" */
/** @import { Studio } from "./studio.js" */

const RARELY = 80; // ms between two seeks on the way
/** How far a key moves, s; Home and End reach past either end. @type {Record<string, number>} */
const STEPS = {
  ArrowLeft: -1,
  ArrowDown: -1,
  ArrowRight: 1,
  ArrowUp: 1,
  PageDown: -10,
  PageUp: 10,
  Home: -Infinity,
  End: Infinity,
};

/** s as a clock has them, once there are minutes. @param {number} s */
export const clock = (s) => {
  const rounded = Math.floor(10 * s + 1e-6) / 10;
  if (rounded < 60) return rounded.toFixed(1);
  const minutes = Math.floor(rounded / 60);
  return `${minutes}:${(rounded - 60 * minutes).toFixed(1).padStart(4, "0")}`;
};

/**
 * What the slider says; tenths only of what stands still, or nobody could listen to it.
 *
 * @param {Pick<Played, "position_s" | "length_s" | "playing">} played
 */
export function spokenPlace({ position_s, length_s, playing }) {
  const place = playing ? Math.floor(position_s) : Number(position_s.toFixed(1));
  return `${place} of ${Number(length_s.toFixed(1))} seconds`;
}

/**
 * What is said at the end; "" before it.
 *
 * @param {Pick<State, "transport" | "source" | "reason">} state
 */
export function endLine({ transport, source, reason }) {
  if (!transport?.ended) return "";
  const what = source.startsWith("take:") ? "The take" : "The clip";
  return `${what} has ended.${reason === "source_ended" ? " The robot stands." : ""}`;
}

/**
 * What comes after a source in a list, from its end back to its start; null for one alone.
 *
 * @param {string[]} list
 * @param {string} source
 */
export function after(list, source) {
  const at = list.indexOf(source);
  return at < 0 || list.length < 2 ? null : list[(at + 1) % list.length];
}

export class TransportBar {
  /** Clips that were played since the page was opened, in that order. @type {string[]} */
  #clips = [];
  /** What comes next, once something has ended. @type {string | null} */
  #next = null;
  /** Of what has ended, the source. */
  #over = "";
  #sent = 0;
  /** Whether the slider is held. */
  #held = false;

  /** @param {Studio} studio @param {() => boolean} elsewhere whether another bar plays the take */
  constructor(studio, elsewhere) {
    this.studio = studio;
    this.elsewhere = elsewhere;
    const at = $input("#transport-at");
    const speed = $select("#transport-speed");
    for (const [button, run] of /** @type {const} */ ([
      ["#transport-play", this.#toggle],
      ["#transport-again", this.#again],
      ["#transport-back", () => this.#step(-1)],
      ["#transport-on", () => this.#step(1)],
      ["#transport-loop", () => this.#loop(!this.#played?.loop)],
      ["#transport-end-again", this.#again],
      ["#transport-end-loop", async () => (await this.#loop(true)) && this.#again()],
      ["#transport-end-next", () => attempt(this.#playNext)],
    ]))
      $(button).addEventListener("click", run);
    at.addEventListener("input", () => this.#seek(+at.value));
    at.addEventListener("pointerdown", () => (this.#held = true));
    for (const end of ["pointerup", "pointercancel", "change"])
      at.addEventListener(end, () => (this.#held = false));
    at.addEventListener("keydown", (event) => this.#key(event));
    speed.addEventListener("change", () => this.#move({ action: "speed", speed: +speed.value }));
  }

  /** What is played, as far as this bar shows it. */
  get #played() {
    return this.elsewhere() ? null : (this.studio.state?.transport ?? null);
  }

  /** @param {Move} body */
  #move = (body) => attempt(() => this.studio.api.post("/api/transport", body));
  #toggle = () => this.#move({ action: this.#played?.playing ? "pause" : "play" });
  #again = () => this.#move({ action: "again" });
  /** @param {boolean} on */
  #loop = (on) => this.#move({ action: "loop", on });
  /** @param {number} frames */
  #step = (frames) => this.#move({ action: "step", frames });

  #seek = rarely(RARELY, (/** @type {number} */ position_s) => {
    this.#sent = performance.now();
    this.#move({ action: "seek", position_s });
  });

  /** @param {KeyboardEvent} event */
  #key(event) {
    const step = STEPS[event.key];
    const played = this.#played;
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    if (step === undefined || !played) return;
    event.preventDefault();
    const at = $input("#transport-at");
    at.value = String(Math.max(0, Math.min(played.length_s, +at.value + step)));
    this.#seek(+at.value);
  }

  #playNext = async () => {
    const { api, state } = this.studio;
    if (!this.#next) return;
    await api.post("/api/source", { source: this.#next });
    if (state?.mode === "replay") await api.post("/api/mode", { mode: "replay" });
  };

  /** What keys do; nothing where nothing is played. @returns {Record<string, () => unknown>} */
  get keys() {
    const when = (/** @type {() => unknown} */ what) => () => this.#played && what();
    return {
      0: when(this.#again),
      P: when(this.#toggle),
      ",": when(() => this.#step(-1)),
      ".": when(() => this.#step(1)),
      L: when(() => this.#loop(!this.#played?.loop)),
    };
  }

  /** What the palette lists. @returns {Entry[]} */
  get entries() {
    if (!this.#played) return [];
    const speeds = [...$select("#transport-speed").options];
    return [
      { words: "Play or pause", key: "P", run: this.#toggle },
      { words: "Play again, from the start", key: "0", run: this.#again },
      { words: "Play: a frame back", key: ",", run: () => this.#step(-1) },
      { words: "Play: a frame on", key: ".", run: () => this.#step(1) },
      { words: "Play in a loop, or once", key: "L", run: this.keys.L },
      ...(this.#next ? [{ words: "Play the next clip", run: this.#playNext }] : []),
      ...speeds.map(({ value, textContent }) => ({
        words: `Play at speed ${textContent}`,
        run: () => this.#move({ action: "speed", speed: +value }),
      })),
    ];
  }

  /** Ten times a second, with the state. @param {State} state */
  draw(state) {
    const played = this.#played;
    const { source } = state;
    if (played && !source.startsWith("take:") && !this.#clips.includes(source))
      this.#clips.push(source);
    $("#transport").hidden = !played;
    if (!played) return;
    const at = $input("#transport-at");
    at.max = String(played.length_s);
    // What was just asked for is not taken back until the studio has heard of it.
    if (!this.#held && performance.now() - this.#sent > 3 * RARELY)
      at.value = String(played.position_s);
    const said = spokenPlace({ ...played, position_s: +at.value });
    if (at.getAttribute("aria-valuetext") !== said) at.setAttribute("aria-valuetext", said);
    const unit = played.length_s < 60 ? " s" : "";
    text($("#transport-time"), `${clock(played.position_s)} / ${clock(played.length_s)}${unit}`);
    const play = $("#transport-play");
    showIcon(play, played.playing ? "pause" : "play");
    play.setAttribute("aria-label", played.playing ? "Pause" : "Play");
    $("#transport-loop").setAttribute("aria-pressed", String(played.loop));
    const speed = $select("#transport-speed");
    if (document.activeElement !== speed) speed.value = String(played.speed);
    this.#drawAble(state, played);
    this.#drawEnd(state);
  }

  /** @param {State} state @param {Played} played */
  #drawAble({ recording, mode, stopped }, played) {
    const watches = document.body.dataset.role === "watch";
    const torn = watches || (recording !== null && mode !== "replay");
    for (const button of ["#transport-back", "#transport-on"])
      $button(button).disabled = torn || played.playing;
    $button("#transport-again").disabled = torn || (stopped && mode !== "replay");
    $input("#transport-at").disabled = torn;
    $select("#transport-speed").disabled = torn;
    $button("#transport-loop").disabled = watches;
    $button("#transport-play").disabled =
      watches || (played.playing ? torn : stopped && mode !== "replay");
  }

  /** @param {State} state */
  #drawEnd(state) {
    const line = endLine(state);
    const { source } = state;
    if (line && this.#over !== source) attempt(() => this.#findNext(source));
    this.#over = line ? source : "";
    text($("#transport-end span"), line);
    $("#transport-end").hidden = !line;
    $("#transport-end-next").hidden = !this.#next;
    text($("#transport-end-next"), source.startsWith("take:") ? "Next take" : "Next clip");
  }

  /** Takes come in the order in which the page lists them. @param {string} source */
  async #findNext(source) {
    this.#next = null;
    const takes = source.startsWith("take:") ? await this.studio.api.get("/api/takes") : null;
    const listed = takes?.map(({ name }) => `take:${name}`).reverse();
    this.#next = after(listed ?? this.#clips, source);
  }
}
