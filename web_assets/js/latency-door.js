// How late the robot is: measured and shown while somebody wants to know it, and loaded then.

import { $ } from "./dom.js";

/** @import { Latency } from "./latency.js" */
/** @import { Camera } from "./webcam-device.js" */

export class LatencyDoor {
  /** While it is open. @type {Latency | null} */
  meter = null;

  /** @param {HTMLElement} details @param {Camera} camera */
  constructor(details, camera) {
    details.addEventListener("toggle", async () => {
      this.meter?.close();
      this.meter = null;
      const open = () => details.hasAttribute("open");
      if (!open()) return;
      const { Latency } = await import("./latency.js");
      if (open()) this.meter ??= new Latency($("div", details), camera);
    });
  }
}
