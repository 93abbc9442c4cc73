// What must not go unnoticed: a stop that did not arrive, and figures that are no longer true.

import { $, $button, text } from "./dom.js";

/** @import { Studio } from "./studio.js" */

const UNHEARD = 1000; // ms until a stop that nobody has confirmed is told of

/** A stop that is not confirmed takes the whole screen, and sounds. */
export class Alarm {
  #title = document.title;
  #pressed = 0;
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  #waiting;
  #raised = false;
  /** Ends the sound. */
  #hush = () => {};

  constructor() {
    $button("#alarm button").addEventListener("click", () => {
      $("#alarm").hidden = true;
    });
  }

  /** A stop was pressed. @param {() => void} otherWay what else might get it through */
  pressed(otherWay) {
    if (this.#pressed) return;
    this.#pressed = performance.now();
    this.#waiting = setTimeout(() => {
      otherWay();
      this.#raise();
    }, UNHEARD);
  }

  /** It has arrived. */
  delivered = () => {
    clearTimeout(this.#waiting);
    if (this.#raised) {
      const late = (performance.now() - this.#pressed) / 1000;
      $("#alarm").dataset.kind = "delivered";
      text($("#alarm b"), "The stop has arrived");
      const said = `${late.toFixed(1)} s after it was pressed. The robot is stopped.`;
      text($("#alarm span"), said);
      $("#alarm button").hidden = false;
      this.#hush();
      document.title = this.#title;
    }
    this.#pressed = 0;
    this.#raised = false;
  };

  /** Say for how long by now. */
  draw() {
    if (!this.#raised) return;
    const seconds = Math.round((performance.now() - this.#pressed) / 1000);
    const said = `The studio has not confirmed it for ${seconds} s. It is sent again and again.`;
    text($("#alarm span"), `${said} Use the robot's own switch.`);
  }

  #raise() {
    this.#raised = true;
    $("#alarm").hidden = false;
    $("#alarm").dataset.kind = "undelivered";
    $("#alarm button").hidden = true;
    text($("#alarm b"), "STOP NOT DELIVERED");
    document.title = "⚠ STOP NOT DELIVERED";
    this.draw();
    this.#sound();
  }

  /** Two tones in turn. Where there is no sound there is the picture. */
  #sound() {
    try {
      const context = new AudioContext();
      const tone = new OscillatorNode(context, { type: "square" });
      tone.connect(new GainNode(context, { gain: 0.15 })).connect(context.destination);
      tone.start();
      const turn = setInterval(() => {
        tone.frequency.value = tone.frequency.value === 880 ? 620 : 880;
      }, 250);
      this.#hush = () => {
        clearInterval(turn);
        context.close();
      };
    } catch {
      this.#hush = () => {};
    }
  }
}

/** A veil over figures that are not of now. @param {Studio} studio */
export function drawStale({ link, silence, silent }) {
  const locked = link === "locked";
  const stale = locked || silent;
  $("#stale").hidden = !stale;
  $("#stale a").hidden = !locked;
  if (!stale) return;
  const title = locked ? "This page is signed out" : `No data for ${Math.round(silence / 1000)} s`;
  text($("#stale b"), title);
  const why = locked ? "The studio has another token now." : "What you see is how it was then.";
  text($("#stale span"), why);
}
