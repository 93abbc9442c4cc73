// A tick for each step of a gait: sounds are scheduled ahead on the audio clock, so that they keep
// time whatever the page is busy with.

const AHEAD = 0.35;

export class Metronome {
  constructor() { this.audio = null; this.sent = new Set(); this.key = ""; this.onBeat = () => {}; }

  // Browsers let a page sound only after somebody has touched it.
  unlock() {
    this.audio ??= window.AudioContext ? new AudioContext() : null;
    this.audio?.resume();
  }

  // beats: s into the motion; t: s into it now; called ten times a second or so.
  follow(beats, t, sound) {
    const key = `${beats.length}:${beats[0]}`;
    if (key !== this.key || t < (this.t ?? 0)) { this.key = key; this.sent.clear(); }
    this.t = t;
    beats.forEach((beat, i) => {
      const wait = beat - t;
      if (this.sent.has(i) || wait < -0.05 || wait > AHEAD) return;
      this.sent.add(i);
      if (sound) this.click(i % 2 ? 1150 : 880, Math.max(0, wait));
      setTimeout(() => this.onBeat(i % 2), 1000 * Math.max(0, wait));
    });
  }

  stop() { this.key = ""; this.t = 0; this.sent.clear(); }

  click(pitch, wait = 0) {
    if (this.audio?.state !== "running") return;
    const at = this.audio.currentTime + wait, tone = this.audio.createOscillator(), gain = this.audio.createGain();
    tone.frequency.value = pitch;
    gain.gain.setValueAtTime(0, at);
    gain.gain.linearRampToValueAtTime(0.35, at + 0.002);
    gain.gain.exponentialRampToValueAtTime(0.001, at + 0.07);
    tone.connect(gain).connect(this.audio.destination);
    tone.start(at);
    tone.stop(at + 0.08);
  }
}
