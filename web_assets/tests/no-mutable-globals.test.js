import { test } from "node:test";

import { RuleTester } from "eslint";

import rule from "../no-mutable-globals.js";

const errors = [{ messageId: "global" }];
const wrong = (/** @type {string[]} */ ...all) => all.map((code) => ({ code, errors }));

test("what a file keeps at its top level is never changed", () => {
  new RuleTester().run("no-mutable-globals", rule, {
    valid: [
      "const NAMES = { a: 1 }; export const named = (key) => NAMES[key] ?? NAMES.a;",
      "const KEYS = [2, 1]; export const sorted = () => KEYS.toSorted();",
      "export function made() { const now = {}; now.t = 1; let n = 0; n += 1; return now; }",
      "const page = new Page(); page.on = true; page.add(1);", // it changes itself
      "const OLD = { a: 1 }; export const copy = (more) => Object.assign({}, OLD, more);",
    ],
    invalid: wrong(
      "let now = 0; export const tell = () => now;",
      "const now = { t: 0 }; export const tick = () => (now.t = 1);",
      "const now = { t: 0 }; export const tick = () => now.t++;",
      "const now = { a: { b: 0 } }; export const tick = () => { now.a.b += 1; };",
      "const now = { t: 0 }; export const end = () => Object.assign(now, { t: null });",
      "const now = { t: 0 }; export const end = () => delete now.t;",
      "const times = []; export const add = (t) => times.push(t);",
      "const kept = { times: [] }; export const add = (t) => kept.times.push(t);",
      "const seen = new Map(); export const see = (k) => seen.set(k, 1);",
    ),
  });
});
