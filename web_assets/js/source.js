// The source panel: the synthetic person's tasks, the keyboard, a dropped file, calibration.

import { $, $input, $select, attempt, el, text, toast } from "./dom.js";
import { Refused, filled } from "./net.js";
import { capital, sourceName, spoken } from "./words.js";
import { SourceReport } from "./source-report.js";

/** @import { State } from "../types/page.js" */
/** @import { Studio } from "./studio.js" */

const MAX_FILE = 64 * 2 ** 20;
const MOTION = /\.(bvh|jsonl|json)$/i;
const SAMPLE = "lean-march-reach.bvh";
const KEYBOARD = "operator:interactive";
const VMC = "vmc";

/** ms until the heading has come to where the button sends it. */
const SETTLES = 900;

/**
 * What calibrating has found.
 *
 * @param {State["calibration"]} before
 * @param {State["calibration"]} after
 */
export function measured(before, after) {
  const turned = Math.round(((after.heading_deg - before.heading_deg + 540) % 360) - 180);
  const way = turned
    ? `straight ahead is ${Math.abs(turned)}° further ${turned > 0 ? "left" : "right"} now`
    : "straight ahead stays where it was";
  return `Calibrated: ${way}; your leg is ${after.leg_length_m.toFixed(2)} m`;
}

export class SourcePanel {
  #shown = "";

  /** @param {Studio} studio */
  constructor(studio) {
    this.studio = studio;
    this.report = new SourceReport(studio);
    const choose = (/** @type {string} */ source) =>
      attempt(() => studio.api.post("/api/source", { source }));
    const task = $select("#task");
    const mirror = $input("#mirror");
    const file = $input("#file");
    task.addEventListener("change", () => choose(task.value));
    for (const [button, source] of [
      ["#keys-drive", KEYBOARD],
      ["#vmc", VMC],
    ])
      $(button).addEventListener("click", () =>
        choose(studio.state?.source === source ? "operator" : source),
      );
    $("#calibrate").addEventListener("click", () =>
      attempt(async () => {
        const before = studio.state?.calibration;
        await studio.api.post("/api/calibrate");
        await new Promise((done) => setTimeout(done, SETTLES));
        const after = studio.state?.calibration;
        if (before && after) toast(measured(before, after), "good");
      }),
    );
    mirror.addEventListener("change", () =>
      attempt(() => studio.api.post("/api/mirror", { mirror: mirror.checked })),
    );
    file.addEventListener("change", () => {
      if (file.files?.[0]) this.open(file.files[0]);
      file.value = "";
    });
    $("#sample").addEventListener("click", () => attempt(this.sample));
  }

  /** Whether the keyboard moves the person. */
  get driving() {
    return this.studio.state?.source === KEYBOARD;
  }

  /** Let a motion file drive the robot, or say why it cannot. @param {File} file */
  async open(file) {
    const { name, size } = file;
    this.#complain("");
    if (!MOTION.test(name))
      return this.#complain(`${name} is not a motion file: drop a .bvh or a .jsonl`);
    if (size > MAX_FILE)
      return this.#complain(
        `${name} is larger than ${MAX_FILE / 2 ** 20} MB: cut it into shorter clips`,
      );
    text($("#dropzone b"), `Reading ${name} …`);
    try {
      await this.studio.api.send("POST", filled("/api/files", { name }), new Blob([file]));
      toast(`${name} drives the robot now`, "good");
    } catch (error) {
      if (!(error instanceof Refused)) throw error;
      const { source } = error.data;
      // Its joints are called as no convention does: a person can say which is which.
      if (typeof source === "string") await this.report.map(source);
      this.#complain(
        typeof source === "string" ? error.message.split(": looked for")[0] : error.message,
      );
    } finally {
      text($("#dropzone b"), "Drop a BVH or JSONL file");
    }
  }

  /** Let the keyboard move the person. */
  drive = () => this.studio.api.post("/api/source", { source: KEYBOARD });

  /** Let the sample that the studio brings along drive the robot. */
  sample = async () => {
    const answer = await fetch(`/assets/samples/${SAMPLE}`);
    await this.open(new File([await answer.blob()], SAMPLE));
  };

  /** @param {string} why "" for nothing */
  #complain(why) {
    text($("#file-error"), why);
    $("#file-error").hidden = !why;
  }

  /** @param {State} state */
  draw(state) {
    const { source, tasks, mirror, calibration } = state;
    this.report.draw(state);
    if (source !== this.#shown) {
      this.#shown = source;
      this.#complain("");
    }
    const name = sourceName(source);
    text($("#chip-source b"), name);
    $("#chip-source").title = `Source of human motion: ${name}`;
    text($("#source-now"), name);
    const select = $select("#task");
    if (select.dataset.names !== tasks.join()) {
      select.dataset.names = tasks.join();
      select.replaceChildren(
        el("option", { value: "", disabled: true }, "not in use"),
        el("option", { value: "operator" }, "Tour of everything"),
        ...tasks.map((task) => el("option", { value: `operator:${task}` }, capital(spoken(task)))),
      );
    }
    const known = [...select.options].some((option) => option.value === source);
    if (document.activeElement !== select || !known) select.value = known ? source : "";
    $("#keys-drive").setAttribute("aria-pressed", String(this.driving));
    $("#vmc").setAttribute("aria-pressed", String(source === VMC));
    const pad = $("#pad");
    const opens = pad.hidden && this.driving;
    pad.hidden = !this.driving;
    if (opens) pad.scrollIntoView({ block: "nearest" });
    const box = $input("#mirror");
    if (document.activeElement !== box) box.checked = mirror;
    const leg = calibration.leg_length_m;
    text($("#calibration"), leg ? `leg ${leg.toFixed(2)} m` : "");
  }
}
