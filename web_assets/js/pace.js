// The page's own line, in a worker: drawing may hold up the page, never the heartbeat. It beats
// twenty times a second for as long as the page itself answers; a page that hangs is a lost page.

import { LastingSocket } from "./socket.js";
import { Stops } from "./stops.js";

const HANGS = 5000; // ms without a word from the page

class Line {
  /** @type {LastingSocket | null} */
  #socket = null;
  #roundTrip = 0;
  #heard = performance.now();
  #said = { keys: [], visible: true };
  #stops = new Stops({
    send: (message) => this.#send(message),
    post: () => postStop(),
    confirmed: (ms) => postMessage({ type: "delivered", ms }),
  });

  open() {
    this.#socket = new LastingSocket("/api/control", {
      up: () => {
        postMessage({ type: "link", link: "up" });
        this.#stops.reconnected();
      },
      down: () => postMessage({ type: "link", link: "down" }),
      heard: (message) => {
        if (message.type === "beat") this.#roundTrip = performance.now() - message.sent;
        else if (message.type === "stopped") {
          if (message.ok) this.#stops.confirm(message.number);
        } else postMessage({ ...message, roundTrip: this.#roundTrip });
      },
    });
  }

  /** @param {object} message */
  #send(message) {
    return this.#socket?.send(message) ?? false;
  }

  beat() {
    postMessage({ type: "ping" });
    const now = performance.now();
    if (now - this.#heard < HANGS)
      this.#send({ type: "beat", sent: now, round_trip_ms: this.#roundTrip, ...this.#said });
  }

  /** Act on a word from the page. @param {any} data */
  hear(data) {
    this.#heard = performance.now();
    if (data.type === "open") {
      this.open();
      setInterval(() => this.beat(), 50);
    } else if (data.type === "said") {
      this.#said = data.said;
      this.beat();
    } else if (data.type === "stop") {
      this.#stops.press();
    }
  }
}

/** The stop by HTTP; whether it was applied. */
async function postStop() {
  const patience = AbortSignal.timeout(2000);
  const answer = await fetch("/api/stop", { method: "POST", signal: patience });
  return answer.ok;
}

const line = new Line();
onmessage = ({ data }) => line.hear(data);
