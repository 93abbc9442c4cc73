// The pose model's worker as the page sees it: one picture at a time, the newest; a worker that
// dies or hangs is started again.

/** @import { Seen } from "./webcam-framing.js" */

const HANGS = 8000; // ms without an answer
const TRIES = 3;

export class PoseModel {
  /** @type {Worker | null} */
  #worker = null;
  #ready = false;
  #askedAt = 0;
  #tries = 0;
  /** @type {{ model: string, delegate: string }} */
  #choice = { model: "lite", delegate: "CPU" };

  /**
   * @param {{ seen: (seen: Seen) => void, ready: (delegate: string) => void,
   *   trouble: (line: string) => void }} hooks
   */
  constructor(hooks) {
    this.hooks = hooks;
    setInterval(() => this.#watch(), 500);
  }

  /** Whether a picture would be looked at now. */
  get idle() {
    return this.#ready && !this.#askedAt;
  }

  /** Load a model, in place of what is loaded. @param {string} model @param {string} delegate */
  open(model, delegate) {
    this.#choice = { model, delegate };
    this.#tries = 0;
    this.#start();
  }

  close() {
    this.#worker?.terminate();
    this.#worker = null;
    this.#ready = false;
    this.#askedAt = 0;
  }

  /**
   * Look at what the video shows.
   *
   * @param {HTMLVideoElement} video
   * @param {number} t ms when it was taken
   */
  async look(video, t) {
    this.#askedAt = performance.now();
    const worker = this.#worker;
    try {
      const picture = await createImageBitmap(video);
      if (worker && worker === this.#worker)
        worker.postMessage({ type: "picture", picture, t }, [picture]);
    } catch {
      this.#askedAt = 0; // the camera went away in the meantime
    }
  }

  #start() {
    this.close();
    const url = new URL("./webcam-worker.js", import.meta.url);
    const worker = (this.#worker = new Worker(url, { type: "module" }));
    worker.onmessage = ({ data }) => this.#hear(data);
    worker.onerror = (event) => {
      event.preventDefault();
      this.#lost(event.message || "it could not be loaded");
    };
    worker.postMessage({ type: "open", ...this.#choice });
  }

  /** @param {any} data */
  #hear(data) {
    if (data.type === "failed") return this.#lost(data.why);
    this.#askedAt = 0;
    if (data.type === "ready") {
      this.#ready = true;
      this.hooks.ready(data.delegate);
    } else {
      this.#tries = 0;
      this.hooks.seen(data.seen);
    }
  }

  #watch() {
    if (this.#askedAt && performance.now() - this.#askedAt > HANGS) this.#lost("it hangs");
  }

  /** @param {string} why */
  #lost(why) {
    this.close();
    if (this.#tries++ < TRIES) {
      this.hooks.trouble(`The pose model stopped (${why}); starting it again`);
      this.#start();
    } else
      this.hooks.trouble(
        `The pose model does not run here (${why}): reload, or try another browser`,
      );
  }
}
