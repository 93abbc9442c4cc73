// Small helpers for the page.

export const $ = (selector, root = document) => root.querySelector(selector);
export const $$ = (selector, root = document) => [...root.querySelectorAll(selector)];

export function el(tag, attributes = {}, ...children) {
  const node = document.createElement(tag);
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith("on")) node.addEventListener(key.slice(2), value);
    else if (key === "class") node.className = value;
    // Our content policy refuses a style attribute; what a script sets is let through.
    else if (key === "style") for (const [name, what] of Object.entries(value)) node.style.setProperty(name, what);
    else if (value === true) node.setAttribute(key, "");
    else if (value !== false && value != null) node.setAttribute(key, value);
  }
  node.append(...children.filter((child) => child != null));
  return node;
}

// Writes only when something changed: this runs thirty times a second.
export function text(node, value) {
  if (node.textContent !== value) node.textContent = value;
}

export function press(group, attribute, value) {
  for (const button of $$("button", group)) {
    const on = String(button.dataset[attribute] === value);
    if (button.getAttribute("aria-pressed") !== on) button.setAttribute("aria-pressed", on);
  }
}

export function toast(message, kind = "") {
  const node = el("div", { class: `toast ${kind}` }, message);
  $("#toasts").append(node);
  setTimeout(() => node.remove(), kind === "good" ? 2500 : 6000);
}

// Run something the user asked for; say why if it is refused.
export async function attempt(action) {
  try { return await action(); } catch (error) { toast(capital(error.message)); return null; }
}

// The newest takes in which every typed word occurs, at most `most` of them, and a line on how many.
export function search(takes, words, most) {
  const plain = (s) => s.toLowerCase().replaceAll("_", " ");
  const wanted = plain(words).split(/\s+/).filter(Boolean);
  const found = takes.filter((take) => {
    const said = plain([take.name, take.label, take.note, take.source].join(" "));
    return wanted.every((word) => said.includes(word));
  });
  const rows = found.slice(-most).reverse();
  const line = wanted.length ? `Showing ${rows.length} of ${found.length} found among ${takes.length}` : `Showing ${rows.length} of ${takes.length}`;
  return { rows, line: rows.length < takes.length ? line : "" };
}

export const capital = (words) => words ? words[0].toUpperCase() + words.slice(1) : words;

export const typing = (node) =>
  node?.isContentEditable || node?.tagName === "TEXTAREA" ||
  (node?.tagName === "INPUT" && !["range", "checkbox", "button", "file"].includes(node.type));

export const onControl = (node) =>
  typing(node) || ["INPUT", "BUTTON", "SELECT", "SUMMARY", "A", "LABEL"].includes(node?.tagName);
