// A phone as the camera: the code that invites it, and the phones that have come.

import { el } from "./dom.js";
import { capital } from "./words.js";

/** @import { Api } from "./net.js" */
/** @import { components } from "../types/api.js" */
/** @typedef {components["schemas"]["PhoneState"]} PhoneState */

const EVERY = 1000; // ms between looks at who has come

/** What the card says. @param {Api} api @param {HTMLElement} place where, while it is shown */
export function phonePanel(api, place) {
  const said = el("p", { class: "note", role: "status" });
  const code = el("img", { class: "code", alt: "Invitation as a QR code", hidden: true });
  const link = el("a", { class: "note", target: "_blank", rel: "noopener" });
  const renew = el("button", { class: "quiet", hidden: true }, "New code");
  const list = el("ul", { class: "phones", "aria-label": "Phones that are connected" });
  place.append(said, code, link, renew, list);
  renew.addEventListener("click", () => ask({ action: "invite" }));

  /** @param {{ action: "invite" | "send_away", name?: string }} body */
  async function ask(body) {
    try {
      draw(await api.post("/api/phone", { name: "", ...body }));
    } catch (error) {
      said.textContent = capital(/** @type {Error} */ (error).message);
    }
  }

  let shown = "";
  /** @param {PhoneState} state */
  function draw(state) {
    said.textContent = state.on
      ? "Scan this with the phone’s camera; it is good once. The phone’s browser will warn: " +
        "this machine made its certificate itself."
      : `${capital(state.why)}.`;
    code.hidden = renew.hidden = !state.on;
    if (state.on && code.src !== state.qr) code.src = state.qr;
    link.textContent = state.on ? "Or open this link on it" : "";
    if (state.on) link.href = state.url;
    const now = JSON.stringify(state.phones.map(({ name, frames_per_s }) => [name, frames_per_s]));
    if (now === shown) return; // a button that is pressed stays where it is
    shown = now;
    const focus = list.contains(document.activeElement)
      ? /** @type {HTMLElement} */ (document.activeElement).dataset.name
      : "";
    list.replaceChildren(
      ...state.phones.map(({ name, frames_per_s }) =>
        el(
          "li",
          {},
          el("b", {}, name),
          ` ${frames_per_s ? `sees you, ${frames_per_s.toFixed(0)} frames/s` : "connected"} `,
          el(
            "button",
            {
              class: "quiet",
              "data-name": name,
              "aria-label": `Send ${name} away`,
              onclick: () => ask({ action: "send_away", name }),
            },
            "Send away",
          ),
        ),
      ),
    );
    if (focus)
      /** @type {HTMLElement | null} */ (list.querySelector(`[data-name="${focus}"]`))?.focus();
  }

  async function look() {
    if (!place.isConnected) return clearInterval(timer);
    await api
      .get("/api/phone")
      .then(draw)
      .catch((error) => (said.textContent = capital(error.message)));
  }
  const timer = setInterval(look, EVERY);
  look();
}
