import assert from "node:assert/strict";
import { test } from "node:test";

import { gathered, jobsOf, wantsImport } from "../js/files.js";

const found = (...paths) => paths.map((path) => ({ path, file: path }));

test("a folder with a tape is a take, whatever is beside it; zips and motions stand alone", () => {
  const jobs = jobsOf(
    found(
      "day/one/tape.mcap",
      "day/one/meta.json",
      "day/one/edits.jsonl",
      "day/one/photo.png",
      "day/notes.txt",
      "day/two/tape.mcap",
      "both.zip",
      "day/walk.bvh",
    ),
  );
  assert.deepEqual(jobs, [
    {
      name: "one",
      files: ["day/one/tape.mcap", "day/one/meta.json", "day/one/edits.jsonl"],
      single: false,
    },
    { name: "two", files: ["day/two/tape.mcap"], single: false },
    { name: "both.zip", files: ["both.zip"], single: true },
    { name: "walk.bvh", files: ["day/walk.bvh"], single: true },
  ]);
});

test("a tape without a folder is a take, and other files are none", () => {
  assert.deepEqual(jobsOf(found("tape.mcap")), [
    { name: "take", files: ["tape.mcap"], single: false },
  ]);
  assert.deepEqual(jobsOf(found("photo.png", "meta.json")), []);
});

const file = (name) => ({ name });
const entry = (path) => ({
  isFile: true,
  isDirectory: false,
  fullPath: path,
  file: (done) => done(file(path)),
});
/** A folder whose reader gives two entries at a time, as a browser's gives a hundred. */
const folder = (path, inside) => ({
  isFile: false,
  isDirectory: true,
  fullPath: path,
  createReader() {
    const rest = [...inside];
    return { readEntries: (done) => done(rest.splice(0, 2)) };
  },
});
/** What a drop carries. @returns {any} */
const transfer = (entries, files) => ({
  items: entries.map((one) => ({ webkitGetAsEntry: () => one })),
  files,
});

test("dropped folders are walked to their last file", async () => {
  const inner = folder("/day/one", [entry("/day/one/tape.mcap")]);
  const paths = ["/day/a", "/day/b", "/day/c"].map(entry);
  const dropped = await gathered(transfer([folder("/day", [...paths, inner])], []));
  assert.deepEqual(
    dropped.map(({ path }) => path),
    ["day/a", "day/b", "day/c", "day/one/tape.mcap"],
  );
});

test("where folders cannot be read, the plain files are taken", async () => {
  const broken = { isFile: true, fullPath: "/x", file: (_, fail) => fail(new Error("gone")) };
  const plain = [{ path: "x.bvh", file: file("x.bvh") }];
  assert.deepEqual(await gathered(transfer([broken], [file("x.bvh")])), plain);
  assert.deepEqual(await gathered(transfer([null], [file("x.bvh")])), plain);
});

test("folders, zips and several files can only be imported; one motion can be played", () => {
  assert.ok(wantsImport(transfer([folder("/day", [])], [file("day")])));
  assert.ok(wantsImport(transfer([], [file("a.zip")])));
  assert.ok(wantsImport(transfer([], [file("a.bvh"), file("b.bvh")])));
  assert.ok(!wantsImport(transfer([entry("/a.bvh")], [file("a.bvh")])));
});
