"""The page as somebody sees it who has never seen it before: words on the screen, mouse, keys.

It knows no name of the code's: a control is what can be pressed and has these words written on it.
"""

import json
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from studio.errors import StudioError
from studio.evaluation.browser import Browser

LOOK = 0.2
"""s between two looks at the screen."""
# Where a control lies whose words (without the key beside them, or of a picture its label) are
# these: [x, y] px, or why it cannot be pressed. Frames of the page count as part of it.
_FIND = """((words) => {
  const said = (node) => {
    const bare = node.cloneNode(true);
    for (const key of bare.querySelectorAll('kbd, .hint')) key.remove();
    return bare.textContent.replace(/\\s+/g, ' ').trim();
  };
  const within = (root) => {
    for (const node of root.querySelectorAll('button, summary, a, label, label b'))
      if (said(node) === words && node.checkVisibility({ visibilityProperty: true })) return node;
    for (const frame of root.querySelectorAll('iframe')) {
      const inside = frame.checkVisibility() && frame.contentDocument;
      const node = inside && within(inside);
      if (node) return node;
    }
    return null;
  };
  const node = within(document);
  if (!node) return 'is not there';
  if (node.disabled) return 'cannot be pressed yet';
  for (let view = node; view; view = view.ownerDocument.defaultView.frameElement)
    view.scrollIntoView({ block: 'center', behavior: 'instant' });
  const box = node.getBoundingClientRect();
  let [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  if (!node.contains(node.ownerDocument.elementFromPoint(x, y))) return 'lies under something else';
  let view = node.ownerDocument.defaultView;
  for (; view !== window; view = view.parent) {
    const frame = view.frameElement.getBoundingClientRect();
    [x, y] = [x + frame.x, y + frame.y];
  }
  return [x, y];
})(WORDS)"""
# All words on the screen.
_READ = """((read) => read(document, read))((root, read) => root.body.innerText + [
  ...root.querySelectorAll('iframe')].map((frame) => frame.checkVisibility() &&
    frame.contentDocument?.body ? read(frame.contentDocument, read) : '').join(' '))"""


class Screen:
    """Eyes and hands. clicks: so far; a file that is dropped is none, nor is a key."""

    def __init__(self, page: Browser, patience: float) -> None:
        """patience: s to wait for anything at most."""
        self.page, self.patience, self.clicks = page, patience, 0

    def press(self, words: str) -> None:
        """Click on what these words are written on, once it can be pressed."""
        x, y = self._place(words)
        at = {"x": x, "y": y, "button": "left", "clickCount": 1}
        for kind in ("mousePressed", "mouseReleased"):
            self.page.ask("Input.dispatchMouseEvent", type=kind, **at)
        self.clicks += 1

    def hold(self, key: str) -> None:
        """Press a letter key, and keep it down."""
        self._key("rawKeyDown", key)

    def let_go(self, key: str) -> None:
        """It comes up again."""
        self._key("keyUp", key)

    def drop(self, file: Path, words: str) -> None:
        """Let go of a file that was dragged there."""
        x, y = self._place(words)
        held = {"items": [], "files": [str(file)], "dragOperationsMask": 1}
        for kind in ("dragEnter", "dragOver", "drop"):
            self.page.ask("Input.dispatchDragEvent", type=kind, x=x, y=y, data=held)

    def read(self, *words: str) -> None:
        """Wait until all of these are to be read somewhere."""
        self._until(lambda: [one for one in words if one not in self.page.evaluate(_READ)])

    def _place(self, words: str) -> tuple[float, float]:
        """Where it lies, once it does not move any more, px."""
        found: Any = None

        def lacks() -> list[str]:
            nonlocal found
            before = found
            found = self.page.evaluate(_FIND.replace("WORDS", json.dumps(words)))
            why = found if isinstance(found, str) else "moves" if found != before else ""
            return [f"{words} ({why})"] if why else []

        self._until(lacks)
        return found[0], found[1]

    def _until(self, lacks: Callable[[], list[str]]) -> None:
        deadline = time.perf_counter() + self.patience
        while missing := lacks():
            if time.perf_counter() > deadline:
                said = ", ".join(missing)
                raise StudioError(f"not on the screen within {self.patience:.0f} s: {said}")
            time.sleep(LOOK)

    def _key(self, kind: str, key: str) -> None:
        code = ord(key.upper())
        about = {"key": key.lower(), "code": f"Key{key.upper()}", "windowsVirtualKeyCode": code}
        self.page.ask("Input.dispatchKeyEvent", type=kind, **about)
