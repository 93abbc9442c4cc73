// Filming the 3-D view, by a button beside Record, and a take from its beginning to its end.

import { $, attempt, el, text, toast } from "./dom.js";

/** @import { Film } from "./filming.js" */
/** @import { Studio } from "./studio.js" */
/** @import { View } from "./view.js" */

const OFTEN = 250; // ms

export class FilmButton {
  /** @type {Film | null} */
  #film = null;
  /** Whether the take that is filmed has begun to play. */
  #played = false;
  /** Of what is filmed; "" for the view as it is. */
  #take = "";
  #button = el("button", {
    id: "film",
    "aria-pressed": "false",
    title: "Film the 3-D view, to a video file",
    onclick: () => this.toggle(),
  });

  /** @param {Studio} studio @param {View} view */
  constructor(studio, view) {
    this.studio = studio;
    this.view = view;
    $(".stage-record").append(this.#button);
    this.#draw();
    setInterval(() => this.#film && this.#look(this.#film), OFTEN);
  }

  toggle = () => attempt(() => (this.#film ? this.#stop() : this.#start("")));

  /** Play a take once, from its beginning or that of its trim, and film it. */
  /** @param {string} name @param {number} t s */
  take = async (name, t) => {
    if (this.#film) await this.#stop();
    await this.studio.api.post("/api/seek", { t, playing: true, speed: 1, loop: false });
    await this.#start(name);
    const stop = el("button", { onclick: () => attempt(() => this.#stop()) }, "Stop");
    toast(`Filming ${name} until it ends`, "good", " ", stop);
  };

  /** @param {string} take */
  async #start(take) {
    const { Film, stamp } = await import("./filming.js");
    this.#film = new Film(this.view, take || `a1-studio-${stamp(new Date())}`);
    this.#take = take;
    this.#played = false;
    this.#draw();
  }

  async #stop() {
    const film = this.#film;
    this.#film = null;
    this.#draw();
    await film?.stop();
  }

  /** Whether it is over. @param {Film} film */
  #look(film) {
    const replay = this.studio.state?.replay;
    const plays = replay?.name === this.#take && replay.playing;
    this.#played ||= Boolean(plays);
    const over = this.#take && (this.#played ? !plays : film.seconds > 5);
    if (over || film.tooLong) attempt(() => this.#stop());
    this.#draw();
  }

  #draw() {
    const film = this.#film;
    this.#button.setAttribute("aria-pressed", String(film !== null));
    text(this.#button, film ? `Stop filming · ${film.seconds.toFixed(0)} s` : "Film");
  }
}
