// What is to be done in a scene: chosen here; what shows it is loaded when there is something.

import { $, $select, attempt, text } from "./dom.js";

/** @import { SceneName, State, Tick } from "../types/page.js" */
/** @import { ScenePanel } from "./scenes.js" */
/** @import { Studio } from "./studio.js" */

/** What is to be done in a scene, from when there is something, or its panel is opened, on. */
export class SceneDoor {
  /** @type {Promise<ScenePanel> | null} */
  #loading = null;
  /** @type {ScenePanel | null} */
  #panel = null;
  #names = $select("#scene-name");

  /** @param {Studio} studio */
  constructor(studio) {
    this.studio = studio;
    this.#names.addEventListener("change", () => this.#choose());
    $("#scene").addEventListener("toggle", () => attempt(this.#load));
  }

  #load = () =>
    (this.#loading ??= (async () => {
      const { ScenePanel } = await import("./scenes.js");
      const panel = new ScenePanel(this.studio, { again: this.keys[8], next: this.keys[9] });
      await panel.load();
      return (this.#panel = panel);
    })());

  keys = {
    8: () => this.#choose(),
    9: () => {
      this.#names.selectedIndex = (this.#names.selectedIndex + 1) % this.#names.length;
      this.#choose();
    },
  };

  /** For the palette. */
  entries = [
    { words: "Scene: again, from its beginning", key: "8", run: this.keys[8] },
    { words: "Scene: the next one", key: "9", run: this.keys[9] },
  ];

  /** The scene that is selected, from its beginning. */
  #choose() {
    const scene = /** @type {SceneName} */ (this.#names.value);
    return attempt(() => this.studio.api.post("/api/scene", { scene }));
  }

  /** Thirty times a second. @param {Tick} tick */
  add(tick) {
    this.#panel?.add(tick);
  }

  /** Ten times a second, with the state. @param {State} state */
  draw(state) {
    const { scene, progress } = state;
    if (document.activeElement !== this.#names) this.#names.value = scene.replace("empty", "free");
    text($("#scene-now"), this.#names.selectedOptions[0]?.textContent ?? "");
    if (progress.steps.length && !this.#loading) attempt(this.#load);
    this.#panel?.draw(state);
  }
}
