// The camera's page as a panel of this one, opened when somebody wants it.

import { el } from "./dom.js";

const PAGE = "/camera?panel";

/**
 * @param {HTMLElement} before the panel that it goes before
 * @param {(target: Window) => void} listen to the keyboard of a window
 */
export function cameraPanel(before, listen) {
  const card = el(
    "details",
    { class: "card camera", id: "camera" },
    el("summary", {}, "Your camera"),
    el(
      "p",
      { class: "note" },
      "Stand in front of a camera; the picture stays in this browser. ",
      el("a", { href: "/camera", target: "_blank" }, "On a page of its own"),
    ),
  );
  before.before(card);
  card.addEventListener("toggle", () => {
    if (!card.open) return card.querySelector("iframe")?.remove(); // and with it the camera
    const frame = el("iframe", { src: PAGE, title: "Your camera" });
    frame.addEventListener("load", () => {
      if (frame.contentWindow) listen(frame.contentWindow);
    });
    card.append(frame);
  });
}
