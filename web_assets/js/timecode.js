// A number in the picture of a fake camera, which says which frame of its film it is: a row of
// cells at the top left (studio/synthetic/time_code.py).

export const BITS = 12;
const CELLS = BITS + 4;
const ACROSS = 40; // cells that would fill the picture's width
const SIZE = 4; // px of a cell as it is looked at

/**
 * The number that cells say, or null where they say none: white, black, bits, one that makes these
 * odd, white.
 *
 * @param {boolean[]} cells
 */
export function number(cells) {
  const bits = cells.slice(2, -1);
  const odd = bits.filter(Boolean).length % 2 === 1;
  if (!cells[0] || cells[1] || !cells[CELLS - 1] || !odd) return null;
  return bits.slice(0, BITS).reduce((sum, bit) => 2 * sum + Number(bit), 0);
}

/** What reads the number in a picture, null where there is none. */
export function timeCodeReader() {
  const paper = /** @type {OffscreenCanvasRenderingContext2D} */ (
    new OffscreenCanvas(CELLS * SIZE, SIZE).getContext("2d", { willReadFrequently: true })
  );
  return (/** @type {HTMLVideoElement} */ video) => {
    const size = video.videoWidth / ACROSS;
    paper.drawImage(video, 0, 0, CELLS * size, size, 0, 0, CELLS * SIZE, SIZE);
    const { data } = paper.getImageData(0, SIZE / 2, CELLS * SIZE, 1);
    const light = (/** @type {number} */ x) => data[4 * x] + data[4 * x + 1] + data[4 * x + 2];
    return number(
      Array.from(
        { length: CELLS },
        (_, k) => light(SIZE * k + SIZE / 2 - 1) + light(SIZE * k + SIZE / 2) > 6 * 128,
      ),
    );
  };
}
