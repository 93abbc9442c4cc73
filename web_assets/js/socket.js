// Sockets to the studio: where they are, and one that comes back by itself.

const SOONEST = 250; // ms until another try, twice as many after each that fails
const LATEST = 2000;

/** @param {string} path */
export const socketUrl = (path) =>
  `${location.protocol === "https:" ? "wss" : "ws"}://${location.host}${path}`;

/** A socket for as long as the page lives; a lost connection is made again. */
export class LastingSocket {
  #wait = SOONEST;
  /** @type {WebSocket | null} */
  #socket = null;

  /**
   * @param {string} path
   * @param {{ heard: (message: any) => void, up?: () => void, down?: () => void }} hooks
   *   heard: what came, read as JSON
   */
  constructor(path, hooks) {
    this.url = socketUrl(path);
    this.hooks = hooks;
    this.#open();
  }

  /** Whether the connection took it: what it does not take is lost. @param {object} message */
  send(message) {
    if (this.#socket?.readyState !== WebSocket.OPEN) return false;
    this.#socket.send(JSON.stringify(message));
    return true;
  }

  #open() {
    const socket = (this.#socket = new WebSocket(this.url));
    socket.onopen = () => {
      this.#wait = SOONEST;
      this.hooks.up?.();
    };
    socket.onmessage = ({ data }) => this.hooks.heard(JSON.parse(data));
    socket.onclose = () => {
      this.hooks.down?.();
      setTimeout(() => this.#open(), this.#wait);
      this.#wait = Math.min(LATEST, 2 * this.#wait);
    };
  }
}
