// Over the video: the skeleton, a silhouette to stand in, and the ring that fills.

import { ANKLES, ELBOWS, HIPS, KNEES, SHOULDERS, TOES, WRISTS } from "./webcam-framing.js";

/** @import { Landmark } from "./webcam-framing.js" */

const LIMBS = [SHOULDERS, ELBOWS, WRISTS].concat([HIPS, KNEES, ANKLES, TOES]);
/** Pairs of landmarks with a bone between them. */
const BONES = [
  SHOULDERS,
  HIPS,
  ...[0, 1].flatMap((side) => [
    [SHOULDERS[side], HIPS[side]],
    ...[0, 1, 3, 4, 5].map((k) => [LIMBS[k][side], LIMBS[k + 1][side]]),
  ]),
];
const SEEN = 0.3; // as the studio: less is not believed

/** @param {HTMLCanvasElement} canvas */
export const painter = (canvas) => {
  const paper = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
  const colour = (/** @type {string} */ name) =>
    getComputedStyle(canvas).getPropertyValue(`--${name}`);

  /** @param {Landmark[]} landmarks */
  const skeleton = (landmarks) => {
    const { width, height } = canvas;
    paper.lineWidth = Math.max(3, height / 110);
    paper.lineCap = "round";
    for (const [a, b] of BONES) {
      const [from, to] = [landmarks[a], landmarks[b]];
      const sure = Math.min(from[3], to[3]);
      paper.globalAlpha = sure < SEEN ? 0.25 : 1;
      paper.strokeStyle = colour(sure < SEEN ? "muted" : "human");
      paper.beginPath();
      paper.moveTo(from[0] * width, from[1] * height);
      paper.lineTo(to[0] * width, to[1] * height);
      paper.stroke();
    }
    paper.globalAlpha = 1;
  };

  /** Where a person would fit: head, trunk, legs. */
  const silhouette = () => {
    const { width, height } = canvas;
    const [x, unit] = [width / 2, height * 0.82];
    const top = height * 0.08;
    const at = (/** @type {number} */ across, /** @type {number} */ down) =>
      /** @type {const} */ ([x + across * unit, top + down * unit]);
    paper.setLineDash([10, 8]);
    paper.lineWidth = 3;
    paper.strokeStyle = "#ffffffb0";
    paper.beginPath();
    paper.arc(...at(0, 0.065), 0.065 * unit, 0, 2 * Math.PI);
    paper.moveTo(...at(-0.03, 0.16));
    for (const side of [-1, 1]) {
      paper.moveTo(...at(0, 0.16));
      paper.lineTo(...at(side * 0.12, 0.18));
      paper.lineTo(...at(side * 0.19, 0.47));
      paper.lineTo(...at(side * 0.14, 0.48));
      paper.lineTo(...at(side * 0.095, 0.27));
      paper.lineTo(...at(side * 0.1, 0.52));
      paper.lineTo(...at(side * 0.085, 1));
      paper.lineTo(...at(side * 0.03, 1));
      paper.lineTo(...at(0, 0.56));
    }
    paper.stroke();
    paper.setLineDash([]);
  };

  /** @param {number} share */
  const ring = (share) => {
    const { width, height } = canvas;
    const radius = 0.09 * height;
    const middle = /** @type {const} */ ([width / 2, radius + 0.04 * height, radius]);
    paper.lineWidth = radius / 4;
    paper.strokeStyle = "#0008";
    paper.beginPath();
    paper.arc(...middle, 0, 2 * Math.PI);
    paper.stroke();
    paper.strokeStyle = colour("good");
    paper.beginPath();
    paper.arc(...middle, -Math.PI / 2, (2 * share - 0.5) * Math.PI);
    paper.stroke();
  };

  /**
   * @param {HTMLVideoElement} video
   * @param {{ landmarks: Landmark[] | null, stand: boolean, filled: number | null }} what
   */
  return (video, { landmarks, stand, filled }) => {
    if (canvas.width !== video.videoWidth || canvas.height !== video.videoHeight) {
      canvas.width = video.videoWidth;
      canvas.height = video.videoHeight;
    }
    paper.clearRect(0, 0, canvas.width, canvas.height);
    if (stand) silhouette();
    if (landmarks) skeleton(landmarks);
    if (filled !== null) ring(filled);
  };
};
