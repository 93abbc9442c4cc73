"""Who drives: the first page to arrive holds control, the others watch until it is handed over.

A page in control that goes silent is noticed by the loop's safety (its heartbeats stop), which is
asked here: nobody has to survive for the robot to stand. Runs on the gateway's event loop only.
"""

import secrets
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from studio.errors import StudioError
from studio.live.commands import Command, ReleaseControl, TakeControl


@dataclass
class Page:
    """One open page: whether it is in sight, which keys it holds down."""

    name: str
    visible: bool = True
    round_trip_ms: float = 0.0
    keys: frozenset[str] = field(default_factory=frozenset)


class PageControl:
    """Pages, and which of them holds control.

    send: puts a command into the loop's queue without waiting. beat: tells the loop that the page
    in control lives. silent: asks it whether that page has gone silent.
    """

    def __init__(
        self,
        send: Callable[[Command], object],
        beat: Callable[[str], object],
        silent: Callable[[str], bool],
    ) -> None:
        self._send, self._beat, self._silent = send, beat, silent
        self.pages: dict[str, Page] = {}
        self.holder: str | None = None
        self.asking: list[str] = []

    def join(self) -> Page:
        """A page opened its socket; it takes control if nobody has it, or who had it is lost."""
        name = f"page-{secrets.token_hex(3)}"
        page = Page(name=name)
        self.pages[name] = page
        if self.free:
            self._take(name)
        return page

    def leave(self, name: str) -> None:
        """A socket closed. Control is not given up: the loop makes the robot stand by itself."""
        self.pages.pop(name, None)
        self._answered(name)

    def beat(self, name: str, *, visible: bool, keys: frozenset[str], round_trip_ms: float) -> None:
        """A heartbeat (20 Hz) of a page; one out of sight goes on beating, and keeps control."""
        page = self.pages[name]
        page.visible, page.keys, page.round_trip_ms = visible, keys, round_trip_ms
        if name == self.holder:
            self._beat(name)

    @property
    def free(self) -> bool:
        """Nobody holds control, or the page that did is gone."""
        return self.holder is None or self.holder not in self.pages or self._silent(self.holder)

    def act(self, action: str, page: str, to: str | None = None) -> None:
        """take, ask for, release, hand_over (to another page) or keep, of those who ask, control.

        Raises StudioError saying what works.
        """
        if page not in self.pages:
            known = ", ".join(self.pages) or "none"
            raise StudioError(f"{page!r} is not an open page; open pages: {known}")
        if action == "take" or (action == "ask" and self.free):
            self._take(page)
        elif action == "ask":
            if page != self.holder and page not in self.asking:
                self.asking.append(page)
        elif action not in ("release", "hand_over", "keep"):
            known = "ask, hand_over, keep, release, take"
            raise StudioError(f"unknown action {action!r}; known: {known}")
        elif page != self.holder:
            raise StudioError(f"{page} does not hold control; {self.holder or 'nobody'} does")
        elif action == "keep":
            self.asking.clear()
        elif action == "release":
            self.holder = None
            self.asking.clear()
            self._send(ReleaseControl(page=page))
        elif to is None or to not in self.pages:
            others = ", ".join(name for name in self.pages if name != page) or "none"
            raise StudioError(f"say to which open page: {others}")
        else:
            self._take(to)

    def refusal(self, page: str | None) -> str:
        """Why a command of `page` is not accepted, or "". Scripts (None) are not pages."""
        if page is None or page == self.holder:
            return ""
        if self.free:
            return "this page watches only; press Take control"
        return "another page holds control; press Take control to drive from here"

    def state(self) -> dict[str, Any]:
        """For the pages: who holds control and how many look."""
        held_by = self.pages.get(self.holder or "")
        return {
            "holder": self.holder,
            "pages": list(self.pages),
            "free": self.free,
            "away": held_by is not None and not held_by.visible,
            "asking": list(self.asking),
        }

    def _take(self, name: str) -> None:
        self.holder = name
        self._answered(name)
        self._send(TakeControl(page=name))

    def _answered(self, name: str) -> None:
        """Whoever has control, or is gone, asks for it no more."""
        if name in self.asking:
            self.asking.remove(name)
