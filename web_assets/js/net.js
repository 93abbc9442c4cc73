// Talking to the studio: requests that say why they failed, and the page's own line.

import { stoppedBy } from "./words.js";

/** @import { Answer, Body, PathOf, StateMessage, Values } from "../types/page.js" */

/** `data`: all that the studio answered. */
export class Refused extends Error {
  /** @param {string} why @param {Record<string, unknown>} [data] */
  constructor(why, data = {}) {
    super(why);
    this.data = data;
  }
}

/**
 * A path of the schema with its braces filled; what is left of the values becomes its query.
 *
 * @param {string} path
 * @param {unknown} [values]
 */
export function filled(path, values) {
  const query = new URLSearchParams();
  let out = path;
  for (const [key, value] of Object.entries(values ?? {})) {
    const place = `{${key}}`;
    if (path.includes(place)) out = out.replace(place, encodeURIComponent(String(value)));
    else query.set(key, String(value));
  }
  return query.size ? `${out}?${query}` : out;
}

/**
 * The HTTP API, typed by its schema. `page`: this page's name while its own line is up. `stops`:
 * how many it knows of, so that no command of its undoes one that it has not seen.
 */
export class Api {
  /** @type {string | null} */
  page = null;
  /** @type {number | null} */
  stops = null;

  /**
   * @template {PathOf<"get">} P
   * @param {P} path
   * @param {Values<P, "get">} [values]
   * @returns {Promise<Answer<P, "get">>}
   */
  get(path, values) {
    return this.send("GET", filled(path, values));
  }

  /**
   * @template {PathOf<"post">} P
   * @param {P} path
   * @param {Body<P, "post">} [body]
   * @param {Values<P, "post">} [values]
   * @returns {Promise<Answer<P, "post">>}
   */
  post(path, body, values) {
    return this.send("POST", filled(path, values), body ?? {});
  }

  /**
   * @template {PathOf<"patch">} P
   * @param {P} path
   * @param {Body<P, "patch">} body
   * @param {Values<P, "patch">} values
   * @returns {Promise<Answer<P, "patch">>}
   */
  patch(path, body, values) {
    return this.send("PATCH", filled(path, values), body);
  }

  /**
   * @template {PathOf<"delete">} P
   * @param {P} path
   * @param {Values<P, "delete">} values
   * @returns {Promise<Answer<P, "delete">>}
   */
  delete(path, values) {
    return this.send("DELETE", filled(path, values));
  }

  /**
   * Whatever the answer's type: `get` and the others know it.
   *
   * @param {string} method
   * @param {string} path
   * @param {unknown} [body] JSON, or a Blob as it is
   * @returns {Promise<any>}
   */
  async send(method, path, body) {
    const raw = body instanceof Blob;
    const headers = this.headers();
    if (body !== undefined && !raw) headers["Content-Type"] = "application/json";
    let answer;
    try {
      answer = await fetch(path, { method, headers, body: raw ? body : JSON.stringify(body) });
    } catch {
      throw new Refused("the studio does not answer");
    }
    const type = answer.headers.get("content-type") ?? "";
    const data = type.includes("json") ? await answer.json() : {};
    if (!answer.ok)
      throw new Refused(
        stoppedBy(data.why ?? data.error ?? `refused (${answer.status})`, this.page),
        data,
      );
    return data;
  }

  /** @returns {Record<string, string>} */
  headers() {
    return {
      ...(this.page !== null && { "X-Studio-Page": this.page }),
      ...(this.stops !== null && { "X-Studio-Stops": String(this.stops) }),
    };
  }
}

/**
 * The page's own line, kept by a worker (pace.js): twenty heartbeats a second with the keys held
 * down, and the emergency stop, past every request that may be waiting, until it is confirmed.
 */
export class ControlLine {
  /** ms to the studio and back. */
  roundTrip = 0;
  #worker = new Worker("/assets/js/pace.js", { type: "module" });

  /**
   * @param {Api} api
   * @param {{ heldKeys: () => string[], onState: (state: StateMessage) => void,
   *   onLink: (link: "up" | "down" | "locked") => void, onDelivered: () => void }} hooks
   */
  constructor(api, { heldKeys, onState, onLink, onDelivered }) {
    this.api = api;
    this.heldKeys = heldKeys;
    this.#worker.onmessage = ({ data }) => {
      if (data.type === "ping") this.#worker.postMessage({ type: "pong" });
      else if (data.type === "state") {
        api.page = data.page;
        api.stops = data.stops;
        this.roundTrip = data.roundTrip;
        onState(data);
      } else if (data.type === "link") {
        onLink(data.link);
        if (data.link === "down") {
          api.page = null;
          api.stops = null;
          // A socket that is refused does not say why; a request does.
          fetch("/api/state").then(
            (answer) => answer.status === 401 && onLink("locked"),
            () => {},
          );
        }
      } else if (data.type === "delivered") onDelivered();
    };
    document.addEventListener("visibilitychange", () => this.say());
    this.#worker.postMessage({ type: "open" });
  }

  /** Beat now, with the keys as they are. */
  say() {
    const said = { keys: this.heldKeys(), visible: !document.hidden };
    this.#worker.postMessage({ type: "said", said });
  }

  /** Emergency stop. */
  stop() {
    this.#worker.postMessage({ type: "stop" });
  }
}
