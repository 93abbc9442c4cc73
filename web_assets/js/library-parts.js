// What the library consists of, before anything is in it.

import { $, el, icon } from "./dom.js";
import { VERDICTS } from "./library-list.js";

const NAMES = { all: "All", kept: "Kept", new: "Undecided", rejected: "Rejected" };
const ORDERS = [
  ["newest", "Newest first"],
  ["oldest", "Oldest first"],
  ["best", "Best score first"],
  ["worst", "Worst score first"],
  ["longest", "Longest first"],
  ["name", "By name"],
];

/** The dialog, closed; its styles come with it. @param {() => void} close */
export function libraryDialog(close) {
  document.head.append(el("link", { rel: "stylesheet", href: "/assets/css/library.css" }));
  const dialog = el(
    "dialog",
    { id: "library", "aria-labelledby": "library-title" },
    el(
      "div",
      { class: "head" },
      el("h2", { id: "library-title" }, "Library"),
      el("span", { class: "note", id: "library-says", role: "status" }),
      el("button", { id: "library-all", title: "All that are listed (Ctrl A)" }, "Select all"),
      el(
        "button",
        { id: "library-bin", "aria-pressed": "false", title: "What was deleted" },
        icon("bin"),
        " Bin",
      ),
      el(
        "button",
        {
          class: "icon",
          id: "library-close",
          title: "Close the library",
          "aria-label": "Close the library",
          onclick: close,
        },
        icon("close"),
      ),
    ),
    el(
      "div",
      { class: "tools" },
      el("input", {
        type: "text",
        id: "library-find",
        placeholder: "Find by name, label, note, source or session",
        "aria-label": "Find takes",
      }),
      el(
        "div",
        { class: "segmented small", id: "library-verdict", role: "group", "aria-label": "Which" },
        ...VERDICTS.map((one) =>
          el("button", { "data-verdict": one, "aria-pressed": String(one === "all") }, NAMES[one]),
        ),
      ),
      el("select", { id: "library-session", "aria-label": "Session" }),
      el(
        "select",
        { id: "library-order", "aria-label": "Order" },
        ...ORDERS.map(([value, words]) => el("option", { value }, words)),
      ),
    ),
    el("ul", { id: "library-list", "aria-label": "Takes" }),
    el("button", { class: "wide", id: "library-more", hidden: true }, "Show more"),
    el(
      "div",
      { class: "many", id: "library-many", role: "group", "aria-label": "Selected takes" },
      el("b", { id: "library-chosen" }),
    ),
  );
  // Before the toasts: what is said lies over it.
  $("#toasts").before(dialog);
  return dialog;
}
