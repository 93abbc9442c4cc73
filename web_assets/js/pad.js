// The pad of driving keys: each is held for as long as a finger, or the mouse, lies on it.

import { $, el } from "./dom.js";
import { DRIVE } from "./keys.js";

/** @import { Keyboard } from "./keys.js" */

/** @param {Keyboard} keyboard */
export function startPad(keyboard) {
  for (const [key, what] of DRIVE) {
    // The Tab key passes it by: who has a keyboard has the keys.
    const button = el("button", { tabindex: -1 }, el("kbd", {}, key), what);
    button.addEventListener("pointerdown", (event) => {
      event.preventDefault();
      button.setPointerCapture(event.pointerId);
      keyboard.hold(key);
    });
    for (const end of ["pointerup", "pointercancel", "lostpointercapture"])
      button.addEventListener(end, () => keyboard.release(key));
    button.addEventListener("contextmenu", (event) => event.preventDefault());
    $("#pad").append(button);
  }
}
