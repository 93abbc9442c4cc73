// Copies what the page serves of its packages from node_modules into vendor/, and nothing else.

import { cpSync, mkdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { basename, join } from "node:path";

import { poseTask } from "./pose_models.js";

const ICONS = [
  "arrow-path",
  "arrow-uturn-left",
  "arrow-uturn-right",
  "backward",
  "chevron-left",
  "chevron-right",
  "moon",
  "pause",
  "play",
  "sun",
  "trash",
  "x-mark",
];
const VISION = "@mediapipe/tasks-vision";
const POSE = "@mediapipe/pose";
/** Folder in vendor/: files of node_modules. */
const FILES = {
  icons: ["heroicons/LICENSE", ...ICONS.map((name) => `heroicons/20/solid/${name}.svg`)],
  uplot: ["LICENSE", "dist/uPlot.esm.js", "dist/uPlot.min.css"].map((file) => `uplot/${file}`),
  mediapipe: [
    `${VISION}/vision_bundle.mjs`,
    ...["js", "wasm"].map((end) => `${VISION}/wasm/vision_wasm_module_internal.${end}`),
  ],
};

const here = import.meta.dirname;
const installed = (/** @type {string} */ file) => join(here, "node_modules", file);
rmSync(join(here, "vendor"), { recursive: true, force: true });
for (const [folder, files] of Object.entries(FILES)) {
  mkdirSync(join(here, "vendor", folder), { recursive: true });
  for (const file of files) cpSync(installed(file), join(here, "vendor", folder, basename(file)));
}

const mediapipe = (/** @type {string} */ name) => join(here, "vendor", "mediapipe", name);
cpSync(installed(`${VISION}/vision.d.ts`), mediapipe("vision_bundle.d.mts"));
// Its types are those of a script; what is served of it is a module.
const types = readFileSync(installed("uplot/dist/uPlot.d.ts"), "utf8");
writeFileSync(
  join(here, "vendor", "uplot", "uPlot.esm.d.ts"),
  types.replace("export = uPlot", "export default uPlot"),
);
const detector = readFileSync(installed(`${POSE}/pose_solution_packed_assets.data`));
for (const model of ["lite", "full"]) {
  const landmarks = readFileSync(installed(`${POSE}/pose_landmark_${model}.tflite`));
  writeFileSync(mediapipe(`pose_${model}.task`), poseTask(detector, landmarks));
}
// The packages carry no text of their licence.
const notice = [VISION, POSE].map((name) => {
  const { version, license } = JSON.parse(readFileSync(installed(`${name}/package.json`), "utf8"));
  return `${name} ${version}, The MediaPipe Authors: ${license}\n`;
});
const TEXT = "The licence: https://www.apache.org/licenses/LICENSE-2.0\n";
writeFileSync(mediapipe("NOTICE"), notice.join("") + TEXT);
