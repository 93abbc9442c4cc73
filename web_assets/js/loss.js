// Loss over the steps of a training, a curve a state, on a logarithmic scale.

/** @import { Training } from "../types/page.js" */

/** @type {Record<string, string>} */
const COLOURS = { stand: "--accent", walk: "--human", sit: "--good" };
const HEIGHT = 110;
const LEFT = 38;
const LEAST = 1e-6; // a loss below it is drawn there

/** @param {number} loss */
const log = (loss) => Math.log10(Math.max(loss, LEAST));

/**
 * The range of exponents that holds every loss, with a little room.
 *
 * @param {Training["states"]} states
 */
export function range(states) {
  const all = Object.values(states).flatMap(({ curve }) => curve.map(([, loss]) => log(loss)));
  return { low: Math.min(...all) - 0.05, high: Math.max(...all) + 0.05 };
}

/** @param {HTMLCanvasElement} canvas @param {Pick<Training, "states">} job */
export function drawLoss(canvas, { states }) {
  const pen = canvas.getContext("2d");
  const width = canvas.clientWidth;
  if (!width || !pen) return;
  const ratio = devicePixelRatio || 1;
  canvas.width = width * ratio;
  canvas.height = HEIGHT * ratio;
  const style = getComputedStyle(document.documentElement);
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.font = "11px system-ui, sans-serif";
  const { low, high } = range(states);
  const y = (/** @type {number} */ exponent) =>
    8 + ((high - exponent) / (high - low)) * (HEIGHT - 24);
  pen.strokeStyle = style.getPropertyValue("--line");
  pen.fillStyle = style.getPropertyValue("--muted");
  for (const exponent of [high, (low + high) / 2, low]) {
    pen.beginPath();
    pen.moveTo(LEFT, y(exponent));
    pen.lineTo(width, y(exponent));
    pen.stroke();
    pen.fillText((10 ** exponent).toPrecision(2), 2, y(exponent) + 4);
  }
  pen.lineWidth = 1.8;
  let label = LEFT + 8;
  for (const [state, { curve, steps = 1 }] of Object.entries(states)) {
    if (!curve.length) continue;
    const colour = style.getPropertyValue(COLOURS[state] ?? "--text");
    pen.strokeStyle = pen.fillStyle = colour;
    pen.beginPath();
    for (const [step, loss] of curve)
      pen.lineTo(LEFT + ((width - LEFT - 4) * step) / steps, y(log(loss)));
    pen.stroke();
    pen.fillText(state, label, HEIGHT - 3);
    label += 44;
  }
}
