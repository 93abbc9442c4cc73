// Training from the page: what to learn from, curves while it learns, and scores.

import { $, $$, $button, $canvas, $input, $select, attempt, el, text, toast } from "./dom.js";
import { drawLoss } from "./loss.js";
import { form, ticked } from "./train-form.js";
import { capital, counted } from "./words.js";

/** @import { Answer, StateScores, Training } from "../types/page.js" */
/** @import { Studio } from "./studio.js" */

/** @typedef {Answer<"/api/datasets", "get">[number]} DataSet */
/** @typedef {"march" | "circles" | "semantic"} Style */

const METHODS = [
  ["yours", "Yours"],
  ["shipped", "Shipped"],
  ["ridge", "Ridge"],
  ["nearest_pair", "Nearest pair"],
];
const OFTEN = 400; // ms between two looks at a training
const OFFERED = 12; // data sets

/**
 * Which states are not trained, and why, in a few words; "" where all are.
 *
 * @param {Record<string, string>} left_out
 */
export function untrained(left_out) {
  const whys = [...new Set(Object.values(left_out))];
  const states = (/** @type {string} */ why) =>
    Object.keys(left_out).filter((state) => left_out[state] === why);
  return whys.map((why) => `${states(why).join(", ")} not trained: ${why}`).join(" · ");
}

/**
 * One line on how a training goes.
 *
 * @param {Pick<Training, "status" | "why" | "name" | "states" | "left_out">} job
 */
export function progress({ status, why, name, states, left_out }) {
  if (status === "failed") return capital(why);
  if (status === "cancelled") return "Cancelled";
  const steps = Object.entries(states).flatMap(([state, { step, steps }]) =>
    steps ? [`${state} ${Math.round((100 * (step ?? 0)) / steps)} %`] : [],
  );
  const now = steps.join(" · ") || "reading takes …";
  const first = status === "done" ? `Trained ${name}: ${Object.keys(states).join(", ")}` : now;
  return [first, untrained(left_out)].filter(Boolean).join(" · ");
}

/** A mapper's name as it may be, of what somebody typed. @param {string} typed */
export const fitName = (typed) => typed.trim().replace(/[^A-Za-z0-9_-]+/g, "-");

export class TrainPanel {
  /** Names of the takes that are ticked. @type {string[]} */
  #takes = [];
  /** @type {Training | null} */
  #job = null;
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  #timer;
  /** @type {string | null} */
  #style = null;
  /** Looks at what there is to learn from, so that only the last one is shown. */
  #looks = 0;

  /** @param {Studio} studio @param {() => void} trained called when a mapper was made */
  constructor(studio, trained) {
    this.studio = studio;
    this.trained = trained;
    $("#train-body").append(...form());
    $("#train-go").addEventListener("click", () => attempt(() => this.#train()));
    $("#train-cancel").addEventListener("click", () =>
      attempt(async () => this.#draw(await studio.api.post("/api/train/cancel"))),
    );
    $("#train-body").addEventListener("change", () => {
      this.#ready();
      this.#look();
    });
    studio.api.get("/api/train").then(
      (job) => {
        if (job) this.#watch(job);
      },
      () => {},
    );
    this.#offerDataSets();
  }

  /** Takes to learn from, by name. @param {string[]} names */
  pick(names) {
    this.#takes = names;
    text(
      $("#train-takes"),
      names.length
        ? `${counted(names.length, "take")} ticked above`
        : "Tick takes above to learn from them",
    );
    this.#ready();
    this.#look();
  }

  /** What there is to learn from. */
  get #from() {
    const dataset = $select("#train-from").value;
    const style = $select("#train-style").value;
    return { ...(dataset ? { dataset } : { takes: this.#takes }), style };
  }

  get #states() {
    const boxes = $$("#train-body .states input:checked");
    return boxes.map((box) => /** @type {HTMLInputElement} */ (box).value);
  }

  /** Say of each chosen state how much there is of it, or why it would not be trained. */
  async #look() {
    const look = ++this.#looks;
    const some = this.studio.collecting && !$button("#train-go").disabled;
    const ask = () => this.studio.api.post("/api/train/pairs", this.#from).catch(() => null);
    const found = some ? await ask() : null;
    if (look !== this.#looks) return;
    const row = (/** @type {string} */ state) => {
      const why = found?.left_out[state];
      const says = why ? `not trained: ${why}` : counted(found?.counts[state] ?? 0, "pair");
      return el("li", { class: why ? "without" : "" }, el("b", {}, capital(state)), says);
    };
    $("#train-pairs").replaceChildren(...(found ? this.#states.map(row) : []));
  }

  #ready() {
    const any = this.#takes.length > 0 || $select("#train-from").value !== "";
    $button("#train-go").disabled = this.#job?.status === "running" || !any;
  }

  async #offerDataSets() {
    const found = await this.studio.api.get("/api/datasets").catch(() => null);
    if (!found) return;
    const select = $select("#train-from");
    const chosen = select.value;
    const words = (/** @type {DataSet} */ { version, takes, count }) =>
      `Data set ${version.slice(0, 8)}: ${counted(takes.length, "take")}, ${count} pairs`;
    select.replaceChildren(
      ticked(),
      ...found
        .reverse()
        .slice(0, OFFERED)
        .map((one) => el("option", { value: one.version }, words(one))),
    );
    select.value = found.some(({ version }) => version === chosen) ? chosen : "";
    select.hidden = !found.length;
  }

  async #train() {
    const states = this.#states;
    if (!states.length) {
      toast("Choose at least one state");
      return;
    }
    const name = fitName($input("#train-name").value);
    const job = await this.studio.api.post("/api/train", {
      ...this.#from,
      ...(name ? { name } : {}),
      states,
      start: /** @type {"shipped" | "scratch"} */ ($select("#train-start").value),
      steps: +$input("#train-steps").value || 0,
    });
    this.#watch(job);
  }

  /** Draw a training, and look again until it ends. @param {Training} job */
  #watch(job) {
    this.#draw(job);
    clearTimeout(this.#timer);
    if (job.status !== "running") return;
    this.#timer = setTimeout(async () => {
      // Where nothing answers, the page says so elsewhere.
      const next = (await this.studio.api.get("/api/train").catch(() => null)) ?? job;
      this.#watch(next);
      if (next.status === "done") this.#done(next);
    }, OFTEN);
  }

  /** @param {Training} job */
  #done({ name, seconds, left_out }) {
    const without = untrained(left_out);
    toast(`${name} is trained in ${seconds.toFixed(0)} s${without && `; ${without}`}`, "good");
    $input("#train-name").value = "";
    this.trained();
    this.#offerDataSets();
    this.#look();
  }

  /** @param {Training} job */
  #draw(job) {
    this.#job = job;
    $("#train-cancel").hidden = job.status !== "running";
    this.#ready();
    text($("#train-says"), progress(job));
    $("#train-says").classList.toggle("error", job.status === "failed");
    const states = Object.values(job.states);
    $("#loss").hidden = !states.some(({ steps }) => steps);
    drawLoss($canvas("#loss"), job);
    const results = states.flatMap(({ result }) => result ?? []);
    $("#train-scores").replaceChildren(...(results.length ? [scores(results)] : []));
  }

  /** What is acted out now is what is learnt. @param {Style} style */
  follow(style) {
    if (style === this.#style) return;
    $select("#train-style").value = this.#style = style;
    this.#look();
  }
}

/**
 * Held-out joint error: the smaller the better; the best of each row stands out.
 *
 * @param {StateScores[]} rows
 */
function scores(rows) {
  const head = METHODS.map(([, title]) => el("th", {}, title));
  const row = (/** @type {StateScores} */ result) => {
    const errors = METHODS.map(([method]) => result.scores[method].joint_rmse_deg);
    const best = Math.min(...errors);
    const cells = errors.map((error, i) =>
      el("td", { class: `${error === best ? "best" : ""} ${i ? "" : "mine"}` }, error.toFixed(2)),
    );
    const { pairs, held_out, seconds } = result;
    const title = `${pairs} pairs; held out: ${held_out}; ${seconds} s`;
    return el("tr", { title }, el("th", {}, capital(result.state)), ...cells);
  };
  return el(
    "table",
    { class: "scores" },
    el("caption", {}, "Joint error on held-out motion, degrees"),
    el("thead", {}, el("tr", {}, el("th", {}, ""), ...head)),
    el("tbody", {}, ...rows.map(row)),
  );
}
