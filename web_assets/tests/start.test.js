import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import test from "node:test";

const MOST = 150_000; // bytes of our own that a page waits for; the rest comes when it is wanted

/** What a module brings with it at once: not what it imports when it is called. */
function brought(url, seen = new Map()) {
  if (seen.has(url.href)) return seen;
  const text = readFileSync(url, "utf8");
  seen.set(url.href, Buffer.byteLength(text));
  for (const [, path] of text.matchAll(/^(?:import|export)\b[^;"']*?["'](\.[^"']+)["']/gm))
    brought(new URL(path, url), seen);
  return seen;
}

test("a page starts with little, and with nothing of what is loaded when it is wanted", () => {
  const all = brought(new URL("../js/app.js", import.meta.url));
  const names = [...all.keys()].map((href) => href.split("/").at(-1));
  assert.ok(names.includes("keys.js"), "the stop's keys are there from the start");
  for (const late of ["collect.js", "review.js", "library.js", "plots.js", "uPlot.esm.js"])
    assert.ok(!names.includes(late), late);
  const bytes = [...all.values()].reduce((sum, size) => sum + size, 0);
  assert.ok(bytes <= MOST, `${bytes} bytes`);
});
