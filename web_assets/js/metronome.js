// A tick for each step of a gait: sounds are scheduled ahead on the audio clock, so that they keep
// time whatever the page is busy with.

const AHEAD = 0.35;

export class Metronome {
  /** @type {AudioContext | null} */
  #audio = null;
  /** @type {Set<number>} */
  #sent = new Set();
  #key = "";
  #t = 0;

  /** @param {(foot: number) => void} onBeat 0 for the left foot, 1 for the right */
  constructor(onBeat) {
    this.onBeat = onBeat;
  }

  /** Browsers let a page sound only after somebody has touched it. */
  unlock() {
    this.#audio ??= window.AudioContext ? new AudioContext() : null;
    this.#audio?.resume();
  }

  /**
   * Called ten times a second or so.
   *
   * @param {number[]} beats s into the motion
   * @param {number} t s into it now
   * @param {boolean} sound
   */
  follow(beats, t, sound) {
    const key = `${beats.length}:${beats[0]}`;
    if (key !== this.#key || t < this.#t) {
      this.#key = key;
      this.#sent.clear();
    }
    this.#t = t;
    beats.forEach((beat, i) => {
      const wait = beat - t;
      if (this.#sent.has(i) || wait < -0.05 || wait > AHEAD) return;
      this.#sent.add(i);
      if (sound) this.click(i % 2 ? 1150 : 880, Math.max(0, wait));
      setTimeout(() => this.onBeat(i % 2), 1000 * Math.max(0, wait));
    });
  }

  stop() {
    this.#key = "";
    this.#t = 0;
    this.#sent.clear();
  }

  /** @param {number} pitch Hz @param {number} [wait] s */
  click(pitch, wait = 0) {
    const audio = this.#audio;
    if (audio?.state !== "running") return;
    const at = audio.currentTime + wait;
    const tone = audio.createOscillator();
    const gain = audio.createGain();
    tone.frequency.value = pitch;
    gain.gain.setValueAtTime(0, at);
    gain.gain.linearRampToValueAtTime(0.35, at + 0.002);
    gain.gain.exponentialRampToValueAtTime(0.001, at + 0.07);
    tone.connect(gain).connect(audio.destination);
    tone.start(at);
    tone.stop(at + 0.08);
  }
}
