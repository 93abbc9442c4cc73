import assert from "node:assert/strict";
import { test } from "node:test";

import { Keyboard, nameOf, onControl, typing } from "../js/keys.js";

const STAGE = { tagName: "BODY" };
const TEXT = { tagName: "INPUT", type: "text" };
const BUTTON = { tagName: "BUTTON" };

/** A key press on what has the focus, as a browser reports it; says what became of it. */
const press = (key, target = STAGE, more = {}) => {
  const code = /^[a-z]$/i.test(key) ? `Key${key.toUpperCase()}` : key;
  /** @type {any} */
  const event = { key, code, target, repeat: false, prevented: false, stopped: false, ...more };
  event.preventDefault = () => (event.prevented = true);
  event.stopImmediatePropagation = () => (event.stopped = true);
  return event;
};

/** A keyboard, what it did, and what it told of the keys held. */
const made = ({ drives = false } = {}) => {
  const done = [];
  const told = [];
  const say = (what) => () => done.push(what);
  const actions = { stop: say("stop"), R: say("reset"), Enter: say("arm"), G: say("go") };
  const tell = (held) => told.push([...held]);
  return { done, told, keyboard: new Keyboard(actions, () => drives, tell) };
};

test("Escape stops from anywhere, a text box included, once a press", () => {
  const { done, keyboard } = made();
  for (const target of [STAGE, TEXT, BUTTON]) {
    const event = press("Escape", target);
    keyboard.down(event);
    assert.ok(event.prevented && event.stopped);
  }
  keyboard.down(press("Escape", STAGE, { repeat: true }));
  assert.deepEqual(done, ["stop", "stop", "stop"]);
});

test("Space stops, but on a control it is the control's", () => {
  const { done, keyboard } = made();
  for (const target of [STAGE, TEXT, BUTTON]) keyboard.down(press(" ", target));
  assert.deepEqual(done, ["stop"]);
});

test("Enter arms, but on a control it is the control's", () => {
  const { done, keyboard } = made();
  for (const target of [BUTTON, TEXT, STAGE]) keyboard.down(press("Enter", target));
  assert.deepEqual(done, ["arm"]);
});

test("what is typed, or pressed with Control, does nothing", () => {
  const { done, keyboard } = made();
  keyboard.down(press("r", TEXT));
  keyboard.down(press("r", STAGE, { ctrlKey: true }));
  assert.deepEqual(done, []);
  keyboard.down(press("r"));
  assert.deepEqual(done, ["reset"]);
});

test("what is told later that keys do is done, too", () => {
  const { done, keyboard } = made();
  keyboard.also({ T: () => done.push("theme"), R: () => done.push("again") });
  for (const key of ["t", "r", "Escape"]) keyboard.down(press(key));
  assert.deepEqual(done, ["theme", "again", "stop"]);
});

test("driving, a key is held until it is let go, and means nothing else", () => {
  const { done, told, keyboard } = made({ drives: true });
  keyboard.down(press("w"));
  keyboard.down(press("w", STAGE, { repeat: true }));
  keyboard.down(press("ArrowUp"));
  keyboard.down(press("g"));
  assert.deepEqual(keyboard.held, ["W", "↑", "G"]);
  keyboard.up(press("w"));
  assert.deepEqual(told, [["W"], ["W", "↑"], ["W", "↑", "G"], ["↑", "G"]]);
  assert.deepEqual(done, []);
  keyboard.clear();
  keyboard.clear();
  assert.deepEqual(told.slice(4), [[]]);
});

test("a key is named by what is written on it, whatever the layout's case", () => {
  assert.equal(nameOf({ key: "W", code: "KeyW" }), "W");
  assert.equal(nameOf({ key: "ArrowLeft", code: "ArrowLeft" }), "←");
  assert.equal(nameOf({ key: ",", code: "Comma" }), ",");
});

test("text boxes take text; sliders and boxes to tick do not", () => {
  assert.ok(typing(TEXT));
  assert.ok(typing({ tagName: "TEXTAREA" }));
  assert.ok(typing({ tagName: "DIV", isContentEditable: true }));
  assert.ok(!typing({ tagName: "INPUT", type: "range" }));
  assert.ok(onControl({ tagName: "INPUT", type: "range" }));
  assert.ok(!onControl(STAGE));
  assert.ok(!onControl(null));
});

test("keys that would fly the view's camera stop at the frame, whether or not they drive", () => {
  for (const drives of [true, false]) {
    const { keyboard } = made({ drives });
    for (const key of ["w", "a", "s", "d", "q", "e", "ArrowUp"]) {
      const event = press(key);
      keyboard.down(event, true);
      assert.ok(event.stopped, key);
    }
    const inPage = press("s");
    keyboard.down(inPage);
    assert.ok(!inPage.stopped);
  }
});

test("a page that goes out of sight, or loses the keyboard, lets go of what is held", () => {
  for (const happens of ["blur", "visibilitychange"]) {
    const { keyboard, told } = made({ drives: true });
    /** @type {any} */
    const target = Object.assign(new EventTarget(), { document: new EventTarget() });
    target.parent = target;
    keyboard.listen(target);
    keyboard.down(press("w"));
    const where = happens === "blur" ? target : target.document;
    where.dispatchEvent(new Event(happens));
    assert.deepEqual(told, [["W"], []]);
  }
});

test("Space never presses Arm", () => {
  const { done, keyboard } = made();
  keyboard.down(press(" ", { tagName: "BUTTON", id: "arm" }));
  assert.deepEqual(done, ["stop"]);
});
