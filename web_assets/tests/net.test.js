import assert from "node:assert/strict";
import { afterEach, beforeEach, mock, test } from "node:test";

import { Api, Refused, filled } from "../js/net.js";

test("a path's braces are filled, and the rest becomes its query", () => {
  assert.equal(filled("/api/takes"), "/api/takes");
  assert.equal(
    filled("/api/takes/{name}/review", { name: "a b/c" }),
    "/api/takes/a%20b%2Fc/review",
  );
  const values = { name: "one", points: 9, aligned: false };
  assert.equal(
    filled("/api/takes/{name}/timeline", values),
    "/api/takes/one/timeline?points=9&aligned=false",
  );
});

const answer = (status, body) =>
  new Response(JSON.stringify(body), { status, headers: { "content-type": "application/json" } });

const fetched = () => /** @type {any} */ (globalThis.fetch).mock;

beforeEach(() => void mock.method(globalThis, "fetch", async () => answer(200, { fine: true })));
afterEach(() => mock.restoreAll());
const asked = () => fetched().calls.at(-1).arguments;

test("a request names its page and carries its body", async () => {
  const api = new Api();
  assert.deepEqual(await api.post("/api/mode", { mode: "idle" }), { fine: true });
  assert.deepEqual(asked(), [
    "/api/mode",
    { method: "POST", headers: { "Content-Type": "application/json" }, body: '{"mode":"idle"}' },
  ]);
  api.page = "page-3";
  await api.patch("/api/takes/{name}", { keep: true }, { name: "one" });
  assert.equal(asked()[0], "/api/takes/one");
  assert.equal(asked()[1].headers["X-Studio-Page"], "page-3");
  await api.get("/api/takes");
  assert.equal(asked()[1].body, undefined);
});

test("a file is sent as it is", async () => {
  const file = new Blob(["HIERARCHY"]);
  await new Api().send("POST", "/api/files?name=a.bvh", file);
  assert.equal(asked()[1].body, file);
  assert.deepEqual(asked()[1].headers, {});
});

test("a refusal says why, in the studio's words", async () => {
  const api = new Api();
  /** @type {[() => unknown, string][]} */
  const refusals = [
    [() => answer(409, { why: "stopped: reset first" }), "stopped: reset first"],
    [() => answer(422, { error: "no such take" }), "no such take"],
    [() => new Response("", { status: 500 }), "refused (500)"],
    [() => Promise.reject(new TypeError("offline")), "the studio does not answer"],
  ];
  for (const [respond, message] of refusals) {
    fetched().mockImplementation(async () => respond());
    await assert.rejects(
      api.post("/api/arm"),
      (error) => error instanceof Refused && error.message === message,
    );
  }
});
