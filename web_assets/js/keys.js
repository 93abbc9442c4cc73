// The keyboard, wherever the focus is: the page, a text box, or inside the framed view.

import { onControl, typing } from "./ui.js";

export const DRIVE = [
  ["W", "march: walk forward"], ["Shift", "with W: faster"],
  ["A", "turn left"], ["D", "turn right"],
  ["Q", "lean left"], ["E", "lean right"],
  ["↑", "bend forward"], ["↓", "lean back"],
  ["←", "twist left"], ["→", "twist right"],
  ["C", "bend the knees"], ["X", "sit"],
  ["F", "left arm up"], ["G", "right arm up"],
];
const NAMES = { ArrowUp: "↑", ArrowDown: "↓", ArrowLeft: "←", ArrowRight: "→" };
const DRIVING = new Set(DRIVE.map(([key]) => key));
const held = new Set();

export const heldKeys = () => [...held];

const nameOf = (event) =>
  NAMES[event.key] ?? (event.code.startsWith("Key") ? event.code.slice(3) : event.key);

// actions: {stop(), key: action …}; driving(): whether driving keys are meant as such.
export function keyboard(actions, driving, changed) {
  const down = (event) => {
    if (event.key === "Escape") {
      // First of all listeners, and nothing else may swallow it.
      event.stopImmediatePropagation();
      event.preventDefault();
      if (!event.repeat) actions.stop();
      return;
    }
    if (typing(event.target) || event.ctrlKey || event.metaKey || event.altKey) return;
    const name = nameOf(event);
    if (event.key === " " && !onControl(event.target)) {
      event.preventDefault();
      if (!event.repeat) actions.stop();
    } else if (driving() && DRIVING.has(name)) {
      event.preventDefault();
      if (!held.has(name)) { held.add(name); changed(held); }
    } else if (!event.repeat && actions[name] && !(event.key === "Enter" && onControl(event.target))) {
      event.preventDefault();
      actions[name]();
    }
  };
  const up = (event) => { if (held.delete(nameOf(event))) changed(held); };
  const clear = () => { if (held.size) { held.clear(); changed(held); } };
  return (target) => {
    target.addEventListener("keydown", down, true);
    target.addEventListener("keyup", up, true);
    target.addEventListener("blur", clear);
    target.document.addEventListener("visibilitychange", clear);
  };
}
