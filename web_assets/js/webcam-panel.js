// The camera's page as a panel of this one, opened when somebody wants it.

import { el } from "./dom.js";

/** @import { Api } from "./net.js" */

const PAGE = "/camera?panel";

/**
 * @param {Api} api
 * @param {HTMLElement} before the panel that it goes before
 * @param {(target: Window) => void} listen to the keyboard of a window
 */
export function cameraPanel(api, before, listen) {
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
  const phone = el(
    "details",
    { class: "phone" },
    el("summary", {}, "Use a phone’s camera instead"),
    el("div", {}),
  );
  card.append(phone);
  phone.addEventListener("toggle", async () => {
    const place = el("div", {});
    phone.lastElementChild?.replaceWith(place);
    if (phone.open) (await import("./phone.js")).phonePanel(api, place);
  });
  before.before(card);
  card.addEventListener("toggle", () => {
    if (!card.open) return card.querySelector("iframe")?.remove(); // and with it the camera
    const frame = el("iframe", { src: PAGE, title: "Your camera" });
    frame.addEventListener("load", () => {
      if (frame.contentWindow) listen(frame.contentWindow);
    });
    phone.before(frame);
  });
}
