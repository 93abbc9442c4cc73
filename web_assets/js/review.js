// Reviewing a take: a timeline of both sides under the 3-D view; scrub, trim, align, clean, judge.

import { throwAway } from "./bin.js";
import { benchOf, drawBench, drawPlaying } from "./bench.js";
import { $, $canvas, attempt, el, takesChanged, toView, toast } from "./dom.js";
import { FRAME } from "./motion.js";
import { filled } from "./net.js";
import { Timeline } from "./timeline.js";

/** @import { Edits, Seek, State, Take } from "../types/page.js" */
/** @import { Actions } from "./bench.js" */
/** @import { PlotsDoor } from "./doors.js" */
/** @import { Studio } from "./studio.js" */

/** Points of each curve. */
const POINTS = 500;
const STILL = { t: 0, playing: false, loop: false, speed: 1 };

export class Review {
  /** The take on the bench. @type {Take | null} */
  #take = null;
  /** Whether the person is shown as aligned. */
  #aligned = true;
  /** The mode to go back to. @type {State["mode"]} */
  #came = "live";
  /** @type {Actions} */
  #actions;
  /** @type {Timeline} */
  #timeline;

  /**
   * @param {Studio} studio
   * @param {(take: string, t: number) => unknown} film from t s on
   * @param {PlotsDoor} plots
   */
  constructor(studio, film, plots) {
    this.studio = studio;
    this.film = film;
    this.plots = plots;
    this.#actions = this.#does();
    $(".stage").append(benchOf(this.#actions));
    this.#timeline = new Timeline($canvas("#timeline"), {
      seek: (t) => this.#seek({ t, playing: false }),
      trim: (range) => this.#edit({ trim: range }),
    });
  }

  /** Whether a take is on the bench. */
  get on() {
    return this.#take !== null;
  }

  /** What keys do; nothing without a take. @returns {Record<string, () => void>} */
  get keys() {
    const act = (/** @type {(take: Take) => void} */ what) => () => this.#take && what(this.#take);
    const on = this.#actions;
    return {
      P: act(on.play),
      ",": act(() => this.#nudge(-1)),
      ".": act(() => this.#nudge(1)),
      I: act((take) => this.#trimTo(take, 0)),
      O: act((take) => this.#trimTo(take, 1)),
      Z: act((take) => take.undoable && on.undo()),
      Y: act((take) => take.redoable && on.redo()),
      L: act(on.loop),
    };
  }

  /** @returns {Actions} */
  #does() {
    const { api } = this.studio;
    const name = () => ({ name: this.#take?.name ?? "" });
    const then = (/** @type {() => Promise<unknown>} */ what) =>
      attempt(async () => {
        await what();
        await this.#reload();
      });
    return {
      close: () => this.close(),
      label: (label) => this.#edit({ label }),
      keep: (keep) => this.#edit({ keep }),
      undo: () => then(() => api.post("/api/takes/{name}/undo", undefined, name())),
      redo: () => then(() => api.post("/api/takes/{name}/redo", undefined, name())),
      save: (format) => {
        if (format === "film") this.#film();
        else this.#export(format);
      },
      split: () =>
        then(async () => {
          const at = this.#now.t;
          const { takes } = await api.post("/api/takes/{name}/split", { at }, name());
          toast(`Split: ${takes[1].name} is the rest`, "good");
        }),
      bin: () => attempt(() => this.#bin()),
      play: () => this.#seek({ playing: !this.#now.playing }),
      speed: (speed) => this.#seek({ speed }),
      loop: () => this.#seek({ loop: !this.#now.loop, playing: true }),
      clean: (which) => then(() => api.post("/api/takes/{name}/clean", { which }, name())),
      align: (warp) =>
        then(async () => {
          const body = { accept: true, warp };
          const done = await api.post("/api/takes/{name}/align", body, name());
          if (warp && !done.warped)
            toast("Evening out the tempo would not agree better: aligned by the lag alone");
        }),
      leave: () =>
        then(() => api.post("/api/takes/{name}/align", { accept: false, warp: false }, name())),
      compare: () =>
        then(async () => {
          this.#aligned = !this.#aligned;
        }),
    };
  }

  /** @param {string} format */
  #export(format) {
    const name = this.#take?.name ?? "";
    const href = filled("/api/takes/{name}/export", { name, format });
    el("a", { href, download: "" }).click();
  }

  #film() {
    const take = this.#take;
    if (take) attempt(() => this.film(take.name, take.trim?.[0] ?? 0));
  }

  get #now() {
    return this.studio.state?.replay ?? STILL;
  }

  /** @param {Seek} body */
  #seek(body) {
    return attempt(() => this.studio.api.post("/api/seek", body));
  }

  /** @param {Edits} changes */
  #edit(changes) {
    return attempt(async () => {
      const name = this.#take?.name ?? "";
      try {
        await this.studio.api.patch("/api/takes/{name}", changes, { name });
      } finally {
        await this.#reload(); // what was refused is not shown as if it were so
      }
    });
  }

  /** Keep the take on the bench, and leave it. */
  async keep() {
    const name = this.#take?.name ?? "";
    await this.studio.api.patch("/api/takes/{name}", { keep: true }, { name });
    await this.close();
  }

  /** @param {number} frames */
  #nudge(frames) {
    this.#seek({ t: Math.max(0, this.#now.t + frames * FRAME), playing: false });
  }

  /** @param {Take} take @param {0 | 1} end */
  #trimTo(take, end) {
    const [start, stop] = take.trim ?? [0, take.seconds];
    const now = Math.round(1000 * this.#now.t) / 1000;
    /** @type {[number, number]} */
    const trim = end === 0 ? [now, stop] : [start, now];
    if (trim[0] < trim[1]) this.#edit({ trim });
  }

  async #bin() {
    const { api } = this.studio;
    const name = this.#take?.name ?? "";
    await throwAway(api, name, () => this.open(name));
    await this.close();
  }

  /** Put a take on the bench and show it. @param {string} name */
  open = (name) =>
    attempt(async () => {
      const { api, state } = this.studio;
      const take = await api.get("/api/takes/{name}", { name });
      if (!this.on) this.#came = !state || state.mode === "replay" ? "live" : state.mode;
      this.#take = take;
      this.#aligned = true;
      document.body.dataset.work = "collect";
      this.#show(true);
      const t = take.trim?.[0] ?? 0;
      await api.post("/api/takes/{name}/show", { ...STILL, t, aligned: true }, { name });
      await this.#reload(false);
    });

  /** Back to what was done before, unless somebody has chosen a mode meanwhile. */
  async close() {
    this.#show(false);
    const back = { mode: this.#came, leaving: /** @type {const} */ ("replay") };
    await attempt(() => this.studio.api.post("/api/mode", back));
    takesChanged();
  }

  /** @param {boolean} on */
  #show(on) {
    if (!on) this.#take = null;
    $("#bench").hidden = !on;
    if (on) toView();
    document.body.toggleAttribute("data-reviewing", on);
    this.plots.show(
      this.#take && {
        name: this.#take.name,
        seek: (t) => this.#seek({ t, playing: false }),
      },
    );
    $(".stage").classList.toggle("has-bench", on);
  }

  /** Read the take on the bench anew. @param {boolean} [show] in the 3-D view, too */
  async #reload(show = true) {
    const { api } = this.studio;
    const name = this.#take?.name;
    if (name === undefined) return;
    const { t, playing, speed, loop } = this.#now;
    const aligned = this.#aligned;
    const [curves, found] = await Promise.all([
      api.get("/api/takes/{name}/timeline", { name, points: POINTS, aligned }),
      api.get("/api/takes/{name}/review", { name }),
    ]);
    const take = await api.get("/api/takes/{name}", { name }); // with the score just given
    if (name !== this.#take?.name) return;
    this.#take = take;
    if (show)
      await api.post("/api/takes/{name}/show", { t, playing, speed, loop, aligned }, { name });
    this.#timeline.load(curves, found);
    drawBench(take, found, aligned, this.#actions);
    if (show) takesChanged();
  }

  /** Ten times a second, with the state. @param {State} state */
  draw({ mode, replay }) {
    if (!this.#take) return;
    if (replay?.name === this.#take.name) {
      drawPlaying(replay, this.#take.seconds);
      this.#timeline.at(replay.t, replay.playing ? replay.speed : 0);
      this.plots.at(replay.t);
    } else if (mode !== "replay" && mode !== this.#came) {
      this.#show(false); // somebody chose another mode
    }
  }
}
