import assert from "node:assert/strict";
import { test } from "node:test";

import { capital, counted, jointName, reportLine } from "../js/words.js";
import { rivalLine, rivalName, search, sourceName, spoken, stoppedBy } from "../js/words.js";

const take = (name, label = "", note = null, source = "operator") => ({
  name,
  label,
  note,
  source,
});

test("words are written as people write them", () => {
  assert.equal(capital("tilt"), "Tilt");
  assert.equal(capital(""), "");
  assert.equal(spoken("sit_manipulate_left"), "sit manipulate left");
  assert.equal(jointName("l_knee"), "left knee");
  assert.equal(jointName("pelvis"), "pelvis");
  assert.equal(counted(1, "flaw"), "1 flaw");
  assert.equal(counted(2, "flaw"), "2 flaws");
});

test("a source is named as its user knows it", () => {
  assert.equal(sourceName("bvh:/tmp/a1/1a2b3c4d_march.bvh"), "march.bvh");
  assert.equal(sourceName("frames:clips/kinect.jsonl"), "kinect.jsonl");
  assert.equal(sourceName("bvh:C:\\clips\\walk.bvh"), "walk.bvh");
  assert.equal(sourceName("operator:interactive"), "keyboard");
  assert.equal(sourceName("operator:tilt"), "operator · tilt");
  assert.equal(sourceName("take:mine"), "take · mine");
  assert.equal(sourceName("operator"), "operator");
  assert.equal(sourceName("vmc"), "VMC app");
  assert.equal(sourceName("vmc:40000"), "VMC app:40000");
});

test("takes are found by every word, in name, label, note or source, the newest first", () => {
  const takes = [take("a", "tilt_left"), take("b", "tilt"), take("c", "", "Left side")];
  const names = (words, most = 9) => search(takes, words, most).rows.map(({ name }) => name);
  assert.deepEqual(names(""), ["c", "b", "a"]);
  assert.deepEqual(names("LEFT"), ["c", "a"]);
  assert.deepEqual(names("tilt left"), ["a"]);
  assert.deepEqual(names("operator", 2), ["c", "b"]);
  assert.deepEqual(names("nothing"), []);
});

test("a list that shows fewer takes than there are says so", () => {
  const takes = [take("a"), take("b"), take("c")];
  assert.equal(search(takes, "", 3).line, "");
  assert.equal(search(takes, "", 2).line, "Showing 2 of 3");
  assert.equal(search(takes, "b", 2).line, "Showing 1 of 1 found among 3");
});

test("what was read of a source is told in a line", () => {
  const report = {
    joints_found: { head: ["Head"], pelvis: ["Hips"] },
    joints_missing: ["left_toe"],
    scale_m: 0.056444,
    up_axis: "y",
    refused: { frames: 1, why: ["frame 3: not finite"] },
    notes: [],
  };
  assert.equal(reportLine(report), "2 of 3 joints · 1 unit = 0.0564 m · up y · 1 frame refused");
  const own = { ...report, scale_m: null, up_axis: null, refused: { frames: 0, why: [] } };
  assert.equal(reportLine(own), "2 of 3 joints");
  const ways = { late_ms: { p50: 2, p95: 21.4, p99: 30 }, wait_ms: { p50: 16.6 } };
  const live = { rate_hz: 29.8, jitter_ms: 3.2, ...ways };
  assert.equal(
    reportLine(own, live),
    "2 of 3 joints · 30 frames a second · jitter 3 ms · up to 21 ms late · read after 17 ms",
  );
});

test("a stop is by this page, by another, or by one that is closed", () => {
  const why = "stopped: emergency stop by page-0a1b2c; reset, then arm";
  assert.match(stoppedBy(why, "page-0a1b2c", ["page-0a1b2c"]), /by this page; reset/);
  assert.match(stoppedBy(why, "page-ffffff", ["page-ffffff", "page-0a1b2c"]), /by another page;/);
  assert.match(stoppedBy(why, "page-ffffff", ["page-ffffff"]), /by a closed page;/);
  assert.equal(stoppedBy("the page is wide", null), "the page is wide");
});

test("a rival is said by whom it is, what it does and what it cannot", () => {
  const rival = {
    name: "kim2020",
    letter: "A",
    title: "Kim et al. 2020: a cycle's phase",
    given: "whole performances",
    source: 'N. H. Kim, "Learning to Correspond", L4DC 2020: trajectories of two systems.',
    limits: "One cycle.",
  };
  assert.equal(rivalName(rival), "(A) Kim et al. 2020");
  assert.equal(
    rivalLine(rival, ["stand", "sit"]),
    "A cycle's phase; fitted to whole performances. " +
      'Source: N. H. Kim, "Learning to Correspond", L4DC 2020. Limits: One cycle. ' +
      "Here it does not map stand and sit: shipped does.",
  );
  const simple = { ...rival, name: "nearest_pair", letter: "", source: "", limits: "" };
  assert.equal(rivalName({ ...simple, title: "the most similar" }), "Nearest pair");
  assert.equal(
    rivalLine({ ...simple, title: "the most similar", given: "every pair" }),
    "The most similar; fitted to every pair.",
  );
});
