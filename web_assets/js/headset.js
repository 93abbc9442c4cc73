// A headset (WebXR): its session, what it shows meanwhile, and what it tracks, to the studio.

import { Still, pressed, worn } from "./headset-frame.js";
import { Driving } from "./webcam-drive.js";
import { capital } from "./words.js";

/** @import { Api } from "./net.js" */

const EVERY = 26; // ms between frames that are sent: headsets have 72 to 120 a second
const MODES = /** @type {const} */ (["immersive-ar", "immersive-vr"]); // the room seen, or not
/** What is seen all around, red, green, blue: to wait, to drive, and not to. */
const TINTS = { quiet: [0.1, 0.2, 0.5], on: [0, 0.35, 0.12], off: [0.45, 0.05, 0.08] };
const THIN = 0.25; // of the tint, where the room is seen through it

export class Headset {
  /** @type {XRSession | null} */
  #session = null;
  #sentAt = 0;
  #held = { stop: false, again: false };
  /** What is tracked now. @type {import("./headset-frame.js").Worn | null} */
  seen = null;

  /**
   * @param {Api} api
   * @param {{ say: (line: string) => void, changed: () => void }} hooks
   */
  constructor(api, { say, changed }) {
    this.say = say;
    this.changed = changed;
    this.driving = new Driving(api, say, {
      source: "headset",
      quiet: new Still(),
      frame: (seen) => seen,
      still: "Stand upright and quiet, hands hanging, until it turns green",
    });
  }

  get on() {
    return this.#session !== null;
  }

  /** Put it on: throws what the browser or the studio refuses, in a line for people. */
  async begin() {
    const session = await this.#asked();
    this.#session = session;
    session.addEventListener("end", () => this.#ended());
    try {
      await this.#follow(session);
    } catch (error) {
      await session.end();
      throw error;
    }
    this.changed();
  }

  /** @param {XRSession} session */
  async #follow(session) {
    const floor = await session.requestReferenceSpace("local-floor");
    const canvas = document.createElement("canvas");
    const gl = canvas.getContext("webgl2", { xrCompatible: true });
    if (!gl) throw new Error("The browser draws nothing for a headset here (no WebGL)");
    const baseLayer = new XRWebGLLayer(session, gl);
    await session.updateRenderState({ baseLayer });
    const next = (/** @type {number} */ _, /** @type {XRFrame} */ frame) => {
      session.requestAnimationFrame(next);
      this.#show(gl, baseLayer);
      this.#look(frame, floor);
    };
    session.requestAnimationFrame(next);
    await this.driving.begin();
  }

  async end() {
    await this.#session?.end();
  }

  async #asked() {
    const xr = /** @type {XRSystem} */ (navigator.xr);
    for (const mode of MODES)
      if (await xr.isSessionSupported(mode))
        return xr.requestSession(mode, {
          requiredFeatures: ["local-floor"],
          optionalFeatures: ["hand-tracking", "body-tracking"],
        });
    throw new Error("No headset was found: put one on, then try again");
  }

  #ended() {
    this.#session = this.seen = null;
    const drove = this.driving.stage !== "off";
    const line = "The headset’s session ended: the robot stands";
    this.driving.end().then(
      () => drove && this.say(line),
      (error) => this.say(capital(error.message)),
    );
    this.changed();
  }

  /** @param {XRFrame} frame @param {XRReferenceSpace} floor */
  #look(frame, floor) {
    const { stop, again } = pressed(frame);
    const was = this.#held;
    this.#held = { stop, again };
    const tried = (/** @type {Promise<void>} */ done) =>
      done.catch((error) => this.say(capital(error.message)));
    if (stop && !was.stop) tried(this.driving.stop());
    else if (again && !was.again && this.driving.stage === "off") tried(this.driving.begin());
    const now = performance.now();
    // Behind the headset's own menu a person drives nothing: the studio hears of nobody.
    if (frame.session.visibilityState !== "visible" || now - this.#sentAt < EVERY) return;
    this.seen = worn(frame, floor, now / 1000);
    if (!this.seen) return;
    this.#sentAt = now;
    this.driving.push(this.seen, true);
  }

  /** @param {WebGL2RenderingContext} gl @param {XRWebGLLayer} layer */
  #show(gl, layer) {
    const seenThrough = this.#session?.environmentBlendMode === "alpha-blend";
    const share = seenThrough ? THIN : 1;
    const { stage, filled } = this.driving;
    const shade = share * (stage === "quiet" ? 0.3 + 0.7 * filled : 1);
    const [r, g, b] = TINTS[stage].map((v) => v * shade);
    gl.bindFramebuffer(gl.FRAMEBUFFER, layer.framebuffer);
    gl.clearColor(r, g, b, seenThrough ? THIN : 1);
    gl.clear(gl.COLOR_BUFFER_BIT);
  }
}
