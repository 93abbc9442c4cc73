// What was seen → WS /api/human, as MediaPipe's skeleton: the studio makes a person of it.

import { socketUrl } from "./socket.js";

/** @import { Seen } from "./webcam-framing.js" */

const OLD = 1; // s: the first picture takes a model long, and is no use by then
const BACKLOG = 20_000; // bytes not yet sent: newer frames matter more than all of them

/** A human frame (docs/contract.md) in metres, to a tenth of a millimetre. @param {Seen} seen */
export function humanFrame({ t, world, landmarks }) {
  if (!world || !landmarks) return null;
  const short = (/** @type {number} */ v) => Math.round(v * 1e4) / 1e4;
  return {
    t,
    skeleton: "mediapipe",
    positions: world.map((joint) => joint.map(short)),
    confidence: landmarks.map(([, , , visibility]) => short(visibility)),
  };
}

export class HumanLink {
  /** @type {WebSocket | null} */
  #socket = null;
  sent = 0;

  /**
   * @param {{ refused: (why: string) => void, lost: () => void }} hooks
   * @param {(seen: any) => object | null} frame what is sent of what was seen
   */
  constructor(hooks, frame) {
    this.hooks = hooks;
    this.frame = frame;
  }

  /** A connection of its own for each time that somebody drives: its clock begins anew. */
  open() {
    this.close();
    const socket = (this.#socket = new WebSocket(socketUrl("/api/human")));
    socket.onmessage = ({ data }) => this.hooks.refused(JSON.parse(data).error);
    socket.onclose = () => {
      if (socket === this.#socket) this.hooks.lost();
    };
  }

  close() {
    const socket = this.#socket;
    this.#socket = null;
    socket?.close();
  }

  /** Send what was seen; nobody seen is nothing to send. @param {{ t: number }} seen */
  send(seen) {
    const socket = this.#socket;
    const frame = performance.now() / 1000 - seen.t < OLD ? this.frame(seen) : null;
    if (!frame || socket?.readyState !== WebSocket.OPEN || socket.bufferedAmount > BACKLOG) return;
    socket.send(JSON.stringify(frame));
    this.sent += 1;
  }
}
