// The bar under a take that is shown again: play, pause, seek, speed.

import { $, $input, $select, attempt, showIcon, text } from "./dom.js";

/** @import { Seek, State } from "../types/page.js" */
/** @import { Studio } from "./studio.js" */

export class ReplayBar {
  /** @param {Studio} studio */
  constructor(studio) {
    const seek = (/** @type {Seek} */ body) => attempt(() => studio.api.post("/api/seek", body));
    const at = $input("#replay-at");
    const speed = $select("#replay-speed");
    $("#replay-play").addEventListener("click", () =>
      seek({ playing: !studio.state?.replay?.playing }),
    );
    at.addEventListener("input", () => seek({ t: +at.value, playing: false }));
    speed.addEventListener("change", () => seek({ speed: +speed.value }));
  }

  /** @param {State} state */
  draw({ mode, replay }) {
    const shown = mode === "replay" ? replay : null;
    $("#replay").hidden = !shown;
    if (!shown) return;
    const at = $input("#replay-at");
    at.max = String(shown.seconds);
    if (document.activeElement !== at || shown.playing) at.value = String(shown.t);
    showIcon($("#replay-play"), shown.playing ? "pause" : "play");
    text($("#replay-time"), `${shown.t.toFixed(1)} / ${shown.seconds.toFixed(1)} s`);
    $select("#replay-speed").value = String(shown.speed);
  }
}
