// The keyboard, wherever the focus is: the page, a text box, or inside the framed view.

/** Keys that drive, and what the person does while they are held. */
export const DRIVE = [
  ["W", "march: walk forward"],
  ["Shift", "with W: faster"],
  ["A", "turn left"],
  ["D", "turn right"],
  ["Q", "lean left"],
  ["E", "lean right"],
  ["↑", "bend forward"],
  ["↓", "lean back"],
  ["←", "twist left"],
  ["→", "twist right"],
  ["C", "bend the knees"],
  ["X", "sit"],
  ["F", "left arm up"],
  ["G", "right arm up"],
];
/** @type {Record<string, string>} */
const NAMES = { ArrowUp: "↑", ArrowDown: "↓", ArrowLeft: "←", ArrowRight: "→" };
const DRIVING = new Set(DRIVE.map(([key]) => key));
/** By these viser flies its camera, under the floor if it likes: here they drive or do nothing. */
const FLYING = new Set(["W", "A", "S", "D", "Q", "E", ...Object.values(NAMES)]);
const UNTYPED = ["range", "checkbox", "button", "file"];
const CONTROLS = ["INPUT", "BUTTON", "SELECT", "SUMMARY", "A", "LABEL"];

/** What the keyboard looks at of an element, in whichever window it lies. */
/** @typedef {{ tagName?: string, id?: string, type?: string, role?: string | null,
 *   isContentEditable?: boolean, dataset?: DOMStringMap }} Focus */

/** Whether keys write text there. @param {Focus | null} node */
export const typing = (node) =>
  Boolean(node?.isContentEditable) ||
  node?.tagName === "TEXTAREA" ||
  (node?.tagName === "INPUT" && !UNTYPED.includes(node.type ?? ""));

/** Whether Space and Enter mean something there. @param {Focus | null} node */
export const onControl = (node) => typing(node) || CONTROLS.includes(node?.tagName ?? "");

/**
 * Whether arrow keys move something there, and drive nobody.
 *
 * @param {Focus | null} node
 */
const slides = (node) =>
  node?.role === "slider" ||
  node?.type === "range" ||
  node?.tagName === "SELECT" ||
  node?.dataset?.arrows !== undefined;

/** A key by what is written on it. @param {{ key: string, code: string }} event */
export const nameOf = ({ key, code }) =>
  NAMES[key] ?? (code.startsWith("Key") ? code.slice(3) : key);

/** Which keys are held down, and what a key that is pressed does. */
export class Keyboard {
  /** @type {Set<string>} */
  #held = new Set();

  /**
   * @param {Record<string, () => unknown> & { stop: () => void }} actions by a key's name
   * @param {() => boolean} driving whether driving keys are meant as such
   * @param {(held: Set<string>) => void} changed
   */
  constructor(actions, driving, changed) {
    this.actions = actions;
    this.driving = driving;
    this.changed = changed;
  }

  /** More of what keys do. @param {Record<string, () => unknown>} actions */
  also(actions) {
    this.actions = { ...this.actions, ...actions };
  }

  /** Names of the keys held down. */
  get held() {
    return [...this.#held];
  }

  /** @param {Window} target */
  listen(target) {
    const framed = target !== target.parent;
    target.addEventListener("keydown", (event) => this.down(event, framed), true);
    target.addEventListener("keyup", (event) => this.up(event), true);
    target.addEventListener("blur", () => this.clear());
    target.document.addEventListener("visibilitychange", () => this.clear());
  }

  /** @param {KeyboardEvent} event @param {boolean} [framed] whether viser listens there, too */
  down(event, framed = false) {
    const focus = /** @type {Focus | null} */ (event.target);
    const name = nameOf(event);
    if (framed && FLYING.has(name)) event.stopImmediatePropagation();
    if (event.key === "Escape") {
      // First of all listeners, and nothing else may swallow it.
      event.stopImmediatePropagation();
      event.preventDefault();
      if (!event.repeat) (this.actions.escape ?? this.actions.stop)();
    } else if (name === "K" && (event.ctrlKey || event.metaKey)) {
      event.preventDefault();
      this.actions.palette?.();
    } else if (typing(focus) || event.ctrlKey || event.metaKey || event.altKey) {
      return;
    } else if ((event.key in NAMES || event.key === "Home") && slides(focus)) {
      return;
    } else if (event.key === " " && (!onControl(focus) || focus?.id === "arm")) {
      event.preventDefault();
      if (!event.repeat) this.actions.stop();
    } else if (this.driving() && DRIVING.has(name)) {
      event.preventDefault();
      this.hold(name);
    } else if (!event.repeat && this.actions[name] && !(name === "Enter" && onControl(focus))) {
      event.preventDefault();
      this.actions[name]();
    }
  }

  /** @param {KeyboardEvent} event */
  up(event) {
    this.release(nameOf(event));
  }

  /** A driving key goes down, by whatever means. @param {string} name */
  hold(name) {
    if (this.driving() && !this.#held.has(name)) this.changed(this.#held.add(name));
  }

  /** @param {string} name */
  release(name) {
    if (this.#held.delete(name)) this.changed(this.#held);
  }

  /** Nothing is held any more: the window lost the keyboard. */
  clear() {
    if (!this.#held.size) return;
    this.#held.clear();
    this.changed(this.#held);
  }
}
