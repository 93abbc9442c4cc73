// The source panel: the synthetic person's tasks, the keyboard, a dropped file, calibration.

import { $, attempt, capital, el, text, toast } from "./ui.js";
import { post, Refused, call } from "./net.js";
import { DRIVE } from "./keys.js";
import { importDrop, wantsImport } from "./imports.js";

const MAX_FILE = 64 * 2 ** 20;

export async function openFile(file) {
  const complain = (why) => { text($("#file-error"), why); $("#file-error").hidden = !why; };
  complain("");
  if (!/\.(bvh|jsonl|json)$/i.test(file.name))
    return complain(`${file.name} is not a motion file: drop a .bvh or a .jsonl`);
  if (file.size > MAX_FILE)
    return complain(`${file.name} is larger than ${MAX_FILE / 2 ** 20} MB: cut it into shorter clips`);
  text($("#dropzone b"), `Reading ${file.name} …`);
  try {
    await call("POST", `/api/files?name=${encodeURIComponent(file.name)}`, new Blob([file]));
    toast(`${file.name} drives the robot now`, "good");
  } catch (error) {
    if (!(error instanceof Refused)) throw error;
    complain(capital(error.message));
  } finally {
    text($("#dropzone b"), "Drop a BVH or JSONL file");
  }
}

export function startSource(app) {
  $("#task").addEventListener("change", (event) => attempt(() => post("/api/source", { source: event.target.value })));
  $("#keys-drive").addEventListener("click", () => {
    const on = app.state?.source === "operator:interactive";
    attempt(() => post("/api/source", { source: on ? "operator" : "operator:interactive" }));
  });
  $("#calibrate").addEventListener("click", () => attempt(async () => {
    await post("/api/calibrate");
    toast("Stand upright and quiet for a moment", "good");
  }));
  $("#mirror").addEventListener("change", (event) => attempt(() => post("/api/mirror", { mirror: event.target.checked })));
  $("#file").addEventListener("change", (event) => {
    if (event.target.files[0]) openFile(event.target.files[0]);
    event.target.value = "";
  });
  $("#pad").append(...DRIVE.map(([key, what]) => el("div", {}, el("kbd", {}, key), what)));
  let depth = 0;
  const collects = () => document.body.dataset.work === "collect";
  const drag = (kind, transfer) => {
    if (kind === "dragenter") depth += 1;
    if (kind === "dragleave") depth = Math.max(0, depth - 1);
    if (kind === "drop") {
      depth = 0;
      // Collecting, a motion is to be kept; live, it is to move the robot at once.
      if (collects() || wantsImport(transfer)) importDrop(transfer);
      else if (transfer?.files?.[0]) openFile(transfer.files[0]);
    }
    $("#drop").hidden = depth === 0;
    text($("#drop span"), collects() ? "takes in folders or a zip, a .bvh or .jsonl motion: they become takes" : "a .bvh or .jsonl motion file plays at once; takes are imported");
  };
  for (const kind of ["dragenter", "dragover", "dragleave", "drop"])
    window.addEventListener(kind, (event) => { event.preventDefault(); drag(kind, event.dataTransfer); });
  document.addEventListener("frame-drag", (event) => drag(event.detail.kind, event.detail.transfer));
}

// "bvh:/tmp/…/1a2b3c4d_march.bvh" is, to a person, "march.bvh".
export const sourceName = (spec) =>
  spec.replace(/^(bvh|frames):.*[\\/]([0-9a-f]{8}_)?/, "").replace(/^operator:interactive$/, "keyboard")
    .replace(/^operator:/, "operator · ").replace(/^take:/, "take · ");

export function drawSource(state) {
  const spec = state.source ?? "";
  text($("#chip-source b"), sourceName(spec));
  $("#chip-source").title = `Source of human motion: ${spec}`;
  text($("#source-now"), sourceName(spec));
  const select = $("#task"), tasks = state.tasks ?? [];
  if (select.dataset.names !== tasks.join()) {
    select.dataset.names = tasks.join();
    select.replaceChildren(
      el("option", { value: "", disabled: true }, "not in use"),
      el("option", { value: "operator" }, "Tour of everything"),
      ...tasks.map((task) => el("option", { value: `operator:${task}` }, capital(task.replaceAll("_", " ")))),
    );
  }
  const known = [...select.options].some((option) => option.value === spec);
  if (document.activeElement !== select || !known) select.value = known ? spec : "";
  const keys = spec === "operator:interactive";
  $("#keys-drive").setAttribute("aria-pressed", keys);
  $("#pad").hidden = !keys;
  if (state.mirror !== undefined && document.activeElement !== $("#mirror")) $("#mirror").checked = state.mirror;
  const c = state.calibration;
  text($("#calibration"), c?.leg_length_m ? `leg ${c.leg_length_m.toFixed(2)} m` : "");
}
