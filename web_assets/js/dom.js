// Finding, making and changing what is on the page.

import { capital } from "./words.js";

/**
 * The first element that matches and is of that kind; an error where the page has none.
 *
 * @template {Element} T
 * @param {{ new (): T }} Kind
 * @param {string} selector
 * @param {ParentNode} [root]
 * @returns {T}
 */
function find(Kind, selector, root = document) {
  const node = root.querySelector(selector);
  if (!(node instanceof Kind)) throw new Error(`the page has no ${Kind.name} ${selector}`);
  return node;
}

/** @param {string} selector @param {ParentNode} [root] */
export const $ = (selector, root) => find(HTMLElement, selector, root);
/** @param {string} selector @param {ParentNode} [root] */
export const $input = (selector, root) => find(HTMLInputElement, selector, root);
/** @param {string} selector @param {ParentNode} [root] */
export const $select = (selector, root) => find(HTMLSelectElement, selector, root);
/** @param {string} selector @param {ParentNode} [root] */
export const $button = (selector, root) => find(HTMLButtonElement, selector, root);
/** @param {string} selector @param {ParentNode} [root] */
export const $canvas = (selector, root) => find(HTMLCanvasElement, selector, root);

/**
 * @param {string} selector
 * @param {ParentNode} [root]
 * @returns {HTMLElement[]}
 */
export const $$ = (selector, root = document) => [...root.querySelectorAll(selector)].map(html);

/** Whether whoever looks wants no motion that is not the robot's. */
export const calm = () => matchMedia("(prefers-reduced-motion: reduce)").matches;

/** What was pressed there until now was lost, so that it could not be. @param {string} selector */
export function hears(selector) {
  for (const part of $$(selector)) part.inert = false;
}

/** The dialog that is open, if one is. */
export const openDialog = () =>
  /** @type {HTMLDialogElement | null} */ (document.querySelector("dialog[open]"));

/** On a phone what is beside the view elsewhere is below it: back to where it is seen. */
export const toView = () => $("main").scrollTo(0, 0);

/** Close it, unless it has something else to leave first. @param {HTMLDialogElement} dialog */
export function leave(dialog) {
  if (dialog.dispatchEvent(new Event("cancel", { cancelable: true }))) dialog.close();
}

/** @param {Element} node */
function html(node) {
  if (node instanceof HTMLElement) return node;
  throw new Error(`${node.tagName} is not of the page's own`);
}

/**
 * A new element. `on…` attributes are listeners, `style` an object of properties; true stands for
 * an attribute without a value, false and null for none.
 *
 * @template {keyof HTMLElementTagNameMap} T
 * @param {T} tag
 * @param {Record<string, any>} [attributes]
 * @param {...(Node | string | null)} children
 * @returns {HTMLElementTagNameMap[T]}
 */
export function el(tag, attributes = {}, ...children) {
  const node = document.createElement(tag);
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith("on")) node.addEventListener(key.slice(2), value);
    else if (key === "class") node.className = value;
    else if (key === "style") setStyle(node, value);
    else if (value === true) node.setAttribute(key, "");
    else if (value !== false && value != null) node.setAttribute(key, value);
  }
  node.append(...children.filter((child) => child !== null));
  return node;
}

/**
 * Our content policy refuses a style attribute; what a script sets is let through.
 *
 * @param {HTMLElement} node
 * @param {Record<string, string | number>} properties
 */
export function setStyle(node, properties) {
  for (const [name, value] of Object.entries(properties))
    node.style.setProperty(name, String(value));
}

/**
 * A picture in a button, which says in words what it does. Its name is a class of icons.css.
 *
 * @param {string} name
 */
export const icon = (name) => el("i", { class: `icon-${name}`, "aria-hidden": "true" });

/** @param {Element} button @param {string} name */
export function showIcon(button, name) {
  const shown = $("i", button);
  if (shown.className !== `icon-${name}`) shown.className = `icon-${name}`;
}

/** Writes only when something changed: this runs thirty times a second. */
export function text(/** @type {Element} */ node, /** @type {string} */ value) {
  if (node.textContent !== value) node.textContent = value;
}

/**
 * Of the buttons of a group, presses the one whose data attribute has the value.
 *
 * @param {ParentNode} group
 * @param {string} attribute
 * @param {string} value
 */
export function press(group, attribute, value) {
  for (const button of $$("button", group)) {
    const on = String(button.dataset[attribute] === value);
    if (button.getAttribute("aria-pressed") !== on) button.setAttribute("aria-pressed", on);
  }
}

/**
 * A word at the top, for a while; longer with something to press.
 *
 * @param {string} message
 * @param {"good" | ""} [kind]
 * @param {...(Node | string)} more
 */
export function toast(message, kind = "", ...more) {
  const node = el("div", { class: `toast ${kind}` }, message, ...more);
  $("#toasts").append(node);
  setTimeout(() => node.remove(), more.length ? 10000 : kind === "good" ? 2500 : 6000);
  return node;
}

/**
 * Run something the user asked for; say why if it is refused.
 *
 * @template T
 * @param {() => Promise<T> | T} action
 * @returns {Promise<T | null>}
 */
export async function attempt(action) {
  try {
    return await action();
  } catch (error) {
    toast(capital(error instanceof Error ? error.message : String(error)));
    return null;
  }
}

/** Takes were made, edited or thrown away: every list of them is read anew. */
export const takesChanged = () => document.dispatchEvent(new CustomEvent("takes-changed"));
