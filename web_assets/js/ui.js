// Small helpers for the page.

export const $ = (selector, root = document) => root.querySelector(selector);
export const $$ = (selector, root = document) => [...root.querySelectorAll(selector)];

export function el(tag, attributes = {}, ...children) {
  const node = document.createElement(tag);
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith("on")) node.addEventListener(key.slice(2), value);
    else if (key === "class") node.className = value;
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

export const capital = (words) => words ? words[0].toUpperCase() + words.slice(1) : words;

export const typing = (node) =>
  node?.isContentEditable || node?.tagName === "TEXTAREA" ||
  (node?.tagName === "INPUT" && !["range", "checkbox", "button", "file"].includes(node.type));

export const onControl = (node) =>
  typing(node) || ["INPUT", "BUTTON", "SELECT", "SUMMARY", "A", "LABEL"].includes(node?.tagName);
