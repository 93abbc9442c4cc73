// Copies what the page serves of its packages from node_modules into vendor/, and nothing else.

import { cpSync, mkdirSync, rmSync } from "node:fs";
import { basename, join } from "node:path";

const ICONS = [
  "arrow-path",
  "arrow-uturn-left",
  "arrow-uturn-right",
  "moon",
  "pause",
  "play",
  "sun",
  "trash",
  "x-mark",
];
/** Folder in vendor/: files of node_modules. */
const FILES = {
  icons: ["heroicons/LICENSE", ...ICONS.map((name) => `heroicons/20/solid/${name}.svg`)],
};

const here = import.meta.dirname;
rmSync(join(here, "vendor"), { recursive: true, force: true });
for (const [folder, files] of Object.entries(FILES)) {
  mkdirSync(join(here, "vendor", folder), { recursive: true });
  for (const file of files)
    cpSync(join(here, "node_modules", file), join(here, "vendor", folder, basename(file)));
}
