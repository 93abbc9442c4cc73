// A scene being played: what to do next over the view, the steps and the best runs in the panel.

import { $, $input, attempt, el, setStyle, text, toView } from "./dom.js";
import { SceneMap } from "./scene-map.js";
import { sourceName } from "./words.js";

/** @import { SceneInfo, State, Tick } from "../types/page.js" */
/** @import { Studio } from "./studio.js" */

/** ms after a scene was finished until its run is on disk. */
const WRITTEN = 800;
const BEST = 5;

/** Minutes and seconds. @param {number} seconds */
export const clock = (seconds) =>
  `${Math.floor(seconds / 60)}:${String(Math.floor(seconds % 60)).padStart(2, "0")}`;

/**
 * What to do now: a title, and a line of what the person does for it.
 *
 * @param {State["progress"]} progress @param {SceneInfo} scene
 */
export function next(progress, scene) {
  const { step, steps, finished, failed, score, time_s } = progress;
  const points = `${score} points in ${clock(time_s)}`;
  if (finished) return { title: "Done!", body: `${points}. Once more, or the next?` };
  if (failed) return { title: `Over: ${failed}.`, body: "Once more? Reset first if it is down." };
  const number = steps.length > 1 ? `${step + 1} of ${steps.length} · ` : "";
  return { title: number + steps[step].text, body: scene.steps[step]?.body ?? "" };
}

export class ScenePanel {
  /** @type {SceneInfo[]} */
  #scenes = [];
  /** What the steps and the best runs were last drawn of. */
  #drawn = "";
  #finished = false;
  #map = new SceneMap();
  #over = $("#scene-over");
  #body = $("#scene-body");

  /** @param {Studio} studio @param {{ again: () => unknown, next: () => unknown }} hooks */
  constructor(studio, { again, next: another }) {
    this.studio = studio;
    const button = (/** @type {string} */ words, /** @type {string} */ key, onclick = again) =>
      el("button", { onclick }, words, el("kbd", {}, key));
    this.#over.append(
      el("div", { class: "row" }, el("b"), el("span", { class: "time" })),
      el("div", { role: "status" }, el("strong"), el("p")),
      el("div", { class: "row" }, button("Again", "8"), button("Next scene", "9", another)),
      this.#map.canvas,
    );
    const person = el("input", {
      type: "text",
      id: "scene-person",
      maxlength: 40,
      placeholder: "Your name, to keep your best runs",
      "aria-label": "Your name, to keep your best runs",
      value: localStorage.getItem("person"),
    });
    person.addEventListener("change", () => attempt(() => this.#name(person.value)));
    this.#body.append(
      el("p", { id: "scene-about" }),
      el("p", { class: "note", id: "scene-nobody" }),
      el("ol", { id: "scene-steps", "aria-label": "Steps" }),
      person,
      el("ol", { id: "scene-best", "aria-label": "Best runs" }),
    );
  }

  /** Read what there is to do; once before anything is drawn. */
  async load() {
    this.#scenes = (await this.studio.api.get("/api/scenes")).scenes;
    this.#drawn = "";
    const name = $input("#scene-person").value;
    // A page that watches may not say who plays.
    if (name && !this.studio.state?.person) this.#name(name).catch(() => {});
  }

  /** @param {string} name */
  async #name(name) {
    localStorage.setItem("person", name);
    await this.studio.api.post("/api/person", { name });
  }

  /** Thirty times a second. @param {Tick} tick */
  add(tick) {
    this.#map.add(tick);
  }

  /** Ten times a second. @param {State} state */
  draw(state) {
    const { progress, source, props, mode } = state;
    const scene = this.#scenes.find(({ name }) => name === progress.name);
    const hidden = !scene || !progress.steps.length || mode === "replay";
    if (this.#over.hidden && !hidden) toView();
    this.#over.hidden = hidden;
    const real = !source.startsWith("operator") || source === "operator:interactive";
    const alone = `Nobody drives: ${sourceName(source)} does not know the scene. `;
    const how = "Drive with the keyboard (Source, above), or with your body.";
    text($("#scene-nobody"), scene?.steps.length && !real ? alone + how : "");
    if (!scene) return;
    if (progress.finished && !this.#finished)
      setTimeout(() => this.load().catch(() => {}), WRITTEN);
    this.#finished = progress.finished;
    this.#drawSteps(progress, scene);
    if (this.#over.hidden) return;
    const { title, body } = next(progress, scene);
    text($("b", this.#over), scene.title);
    text($(".time", this.#over), `${clock(progress.time_s)} · ${progress.score} points`);
    text($("strong", this.#over), title);
    text($("[role=status] p", this.#over), body);
    this.#over.dataset.kind = progress.finished ? "done" : progress.failed ? "over" : "";
    if (this.studio.tick) this.#map.draw(scene, props, this.studio.tick);
  }

  /** @param {State["progress"]} progress @param {SceneInfo} scene */
  #drawSteps({ step, steps, finished }, scene) {
    const what = JSON.stringify([step, steps, scene.name, scene.best]);
    if (what === this.#drawn) return;
    this.#drawn = what;
    text($("#scene-about"), scene.about);
    const rows = steps.map(({ text: goal, done, t }, i) =>
      el(
        "li",
        { class: done ? "done" : "", "aria-current": i === step && !finished ? "step" : null },
        el("span", {}, done ? "✓" : `${i + 1}`),
        el("div", {}, goal, done ? null : el("small", {}, scene.steps[i]?.body ?? "")),
        t === null ? null : el("em", {}, clock(t)),
      ),
    );
    $("#scene-steps").replaceChildren(...rows);
    const best = scene.best
      .slice(0, BEST)
      .map(({ person, score, time_s, source }) =>
        el(
          "li",
          { title: `by ${source}` },
          el("span", {}, person),
          el("em", {}, `${score} points`),
          el("em", {}, clock(time_s)),
        ),
      );
    $("#scene-best").replaceChildren(...best);
    setStyle($("#scene-best"), { display: best.length ? "" : "none" });
  }
}
