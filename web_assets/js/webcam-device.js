// The camera: asked for, opened, watched, and why it cannot be had, in words.

/** What may go wrong with getUserMedia, and what to do about it. @type {Record<string, string>} */
const TROUBLE = {
  NotAllowedError:
    "The camera is not allowed: allow it in the browser's address bar, then try again",
  NotFoundError: "No camera was found: plug one in, then try again",
  NotReadableError: "The camera is in use by another program: close that, then try again",
  OverconstrainedError: "That camera is gone: choose another",
  SecurityError: "The browser gives no camera to this page",
};
const INSECURE =
  "The browser gives a camera only to https or to this computer itself: open the page as " +
  "http://localhost, or serve with --cert and --key";

/** A line for what getUserMedia threw. @param {unknown} error */
export function trouble(error) {
  const { name, message } = /** @type {Error} */ (error);
  return TROUBLE[name] ?? `The camera cannot be used: ${message || name}`;
}

export class Camera {
  /** @type {MediaStream | null} */
  #stream = null;
  #lastAt = 0;
  /** Whether the browser says when a frame was taken; else it is when it came to the page. */
  stamped = false;

  /**
   * @param {HTMLVideoElement} video
   * @param {{ frame: (t: number, came: number) => void, lost: (line: string) => void }} hooks
   *   t, came: ms on the page's clock when the frame was taken, and when it came to the page
   */
  constructor(video, hooks) {
    this.video = video;
    this.hooks = hooks;
    this.#next();
  }

  get on() {
    return this.#stream !== null;
  }

  /** What is open: its deviceId. */
  get id() {
    return this.#stream?.getVideoTracks()[0]?.getSettings().deviceId ?? "";
  }

  /**
   * Open a camera; throws an Error with a line for people.
   *
   * @param {string} id "" for any @param {number} height px
   */
  async open(id, height) {
    this.close();
    if (!navigator.mediaDevices) throw new Error(INSECURE);
    const size = { width: { ideal: (height * 4) / 3 }, height: { ideal: height } };
    const video = { ...size, frameRate: { ideal: 30 }, ...(id && { deviceId: { exact: id } }) };
    try {
      this.#stream = await navigator.mediaDevices.getUserMedia({ video, audio: false });
    } catch (error) {
      throw new Error(trouble(error), { cause: error });
    }
    for (const track of this.#stream.getVideoTracks())
      track.addEventListener("ended", () => {
        this.close();
        this.hooks.lost("The camera was unplugged or taken away: the robot stands");
      });
    this.video.srcObject = this.#stream;
    await this.video.play();
  }

  close() {
    for (const track of this.#stream?.getTracks() ?? []) track.stop();
    this.#stream = null;
    this.video.srcObject = null;
  }

  /** Cameras there are; their names are empty until one was allowed. */
  async list() {
    const all = (await navigator.mediaDevices?.enumerateDevices()) ?? [];
    return all.filter(({ kind }) => kind === "videoinput");
  }

  #next() {
    this.video.requestVideoFrameCallback((now, { captureTime }) => {
      const came = performance.now();
      // Not all browsers know when a frame was taken; a clock that runs backwards is no clock.
      const t = Math.max(captureTime ?? now, this.#lastAt + 1);
      this.#lastAt = t;
      this.stamped = captureTime !== undefined;
      if (this.on) this.hooks.frame(t, came);
      this.#next();
    });
  }
}
