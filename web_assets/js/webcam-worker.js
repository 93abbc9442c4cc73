// MediaPipe's pose model, in a worker of its own: pictures in, landmarks out. All that it loads
// comes from the studio, and nothing leaves this computer's browser but what the page sends on.

import { FilesetResolver, PoseLandmarker } from "../vendor/mediapipe/vision_bundle.mjs";

/** @import { NormalizedLandmark, Landmark } from "../vendor/mediapipe/vision_bundle.mjs" */

const HOME = new URL("../vendor/mediapipe/", import.meta.url).pathname.replace(/\/$/, "");
const COUNTED = 2000; // ms between looks for a second person: one costs as much as two pictures
const THUMB = 24; // px, of the picture whose light is measured

/** @typedef {"lite" | "full"} Model */
/** @typedef {"CPU" | "GPU"} Delegate */

class Watcher {
  #people = 0;
  #countedAt = -Infinity;
  #thumb = /** @type {OffscreenCanvasRenderingContext2D} */ (
    new OffscreenCanvas(THUMB, THUMB).getContext("2d", { willReadFrequently: true })
  );

  /**
   * @param {PoseLandmarker} follower
   * @param {PoseLandmarker} counter looks for a second person
   */
  constructor(follower, counter) {
    this.follower = follower;
    this.counter = counter;
  }

  /** What is seen in a picture taken at t (ms). @param {ImageBitmap} picture @param {number} t */
  see(picture, t) {
    const begun = performance.now();
    const { landmarks, worldLandmarks } = this.follower.detectForVideo(picture, t);
    const seen = {
      landmarks: landmarks[0]?.map(flat) ?? null,
      world: worldLandmarks[0]?.map(({ x, y, z }) => [x, y, z]) ?? null,
    };
    if (begun - this.#countedAt > COUNTED) {
      this.#people = this.counter.detect(picture).landmarks.length;
      this.#countedAt = begun;
    }
    return {
      ...seen,
      ms: performance.now() - begun,
      people: seen.world ? Math.max(1, this.#people) : 0,
      light: this.#light(picture),
    };
  }

  /** Its mean, 0 to 255. @param {ImageBitmap} picture */
  #light(picture) {
    this.#thumb.drawImage(picture, 0, 0, THUMB, THUMB);
    const { data } = this.#thumb.getImageData(0, 0, THUMB, THUMB);
    let sum = 0;
    for (let i = 0; i < data.length; i += 4) sum += data[i] + data[i + 1] + data[i + 2];
    return sum / (3 * THUMB * THUMB);
  }
}

/** @param {NormalizedLandmark | Landmark} landmark */
const flat = ({ x, y, z, visibility }) => [x, y, z, visibility ?? 0];

/**
 * @param {Model} model
 * @param {Delegate} delegate
 * @param {"VIDEO" | "IMAGE"} runningMode
 * @param {number} numPoses
 */
async function landmarker(model, delegate, runningMode, numPoses) {
  const files = await FilesetResolver.forVisionTasks(HOME, true);
  // Each one takes the factory away, and a module that was loaded does not set it again.
  Object.assign(self, { ModuleFactory: (await import(files.wasmLoaderPath)).default });
  const baseOptions = { modelAssetPath: `${HOME}/pose_${model}.task`, delegate };
  return PoseLandmarker.createFromOptions(files, { baseOptions, runningMode, numPoses });
}

/** Does what the page asks: open a model, look at a picture. */
class PoseWorker {
  /** @type {Watcher | null} */
  #watcher = null;

  /**
   * @param {Model} model
   * @param {Delegate} delegate
   * @returns {Promise<void>}
   */
  async #open(model, delegate) {
    try {
      const follower = await landmarker(model, delegate, "VIDEO", 1);
      this.#watcher = new Watcher(follower, await landmarker("lite", delegate, "IMAGE", 2));
    } catch (error) {
      if (delegate === "GPU") return this.#open(model, "CPU");
      return postMessage({ type: "failed", why: String(error) });
    }
    postMessage({ type: "ready", delegate });
  }

  /** @param {any} data */
  hear(data) {
    if (data.type === "open") this.#open(data.model, data.delegate);
    else if (this.#watcher) {
      const { picture, t } = data;
      try {
        postMessage({ type: "seen", seen: { ...this.#watcher.see(picture, t), t: t / 1000 } });
      } catch (error) {
        postMessage({ type: "failed", why: String(error) });
      }
      picture.close();
    }
  }
}

const worker = new PoseWorker();
onmessage = ({ data }) => worker.hear(data);
