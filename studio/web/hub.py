"""What routes share: the loop, who controls it, the feed, and how a command is answered."""

import asyncio
import logging
from collections.abc import Callable
from concurrent.futures import Executor, ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

import msgspec
from fastapi import HTTPException, Request

from studio.control.controllers import CONTROLLERS
from studio.errors import StudioError
from studio.live.commands import Command, Result, Stop
from studio.live.loop import LiveLoop
from studio.reference.library import TASKS
from studio.takes.as_json import plain
from studio.web.access import AccessConfig
from studio.web.feed import TickFeed
from studio.web.keyboard import intent_of
from studio.web.page_control import PageControl
from studio.web.phone import Phones
from studio.web.stop_order import STOPS_KNOWN, StopOrder
from studio.web.supervisor import Supervisor
from studio.web.worker_process import WorkerProcess

T = TypeVar("T")
log = logging.getLogger(__name__)
ANSWER_TIMEOUT = 8.0
"""s to wait for the loop's answer: a reset may take 3, a file's source a few more."""
NAMES = {"tasks": list(TASKS), "controllers": list(CONTROLLERS)}
"""What a state is told with, for those who choose."""


@dataclass(kw_only=True)
class Hub:
    """One running studio, as its routes see it. sessions: the folder of takes. scratch: for files
    that do not outlive the process. phones: None without --phone."""

    loop: LiveLoop
    access: AccessConfig
    control: PageControl
    feed: TickFeed
    supervisor: Supervisor
    sessions: Path
    scratch: Path
    phones: Phones | None = None

    def __post_init__(self) -> None:
        self.stop_order = StopOrder(lambda: self.loop.stops)
        # A stop never queues behind other commands, nor a command behind work on files.
        self.stops = ThreadPoolExecutor(max_workers=16, thread_name_prefix="stop")
        self.commands = ThreadPoolExecutor(max_workers=4, thread_name_prefix="command")
        self.workers = ThreadPoolExecutor(max_workers=4, thread_name_prefix="files")
        # One at a time: a thread that reads a large file leaves Python to nobody for long.
        self.opening = ThreadPoolExecutor(max_workers=1, thread_name_prefix="open")
        # Two: whoever asks for another mapper ends what the one before waits for.
        self.fitting = ThreadPoolExecutor(max_workers=2, thread_name_prefix="fit")
        self.worker_process = WorkerProcess()
        self._encoded: tuple[Any, bytes] = (None, b"")
        self.at_close: list[Callable[[], None]] = [
            self.worker_process.close,
            lambda: self.loop.runtime.mappers.fitting.cancel(),
        ]

    async def submit(self, command: Command, seen: int | None = None) -> Result:
        """Ask the loop from the event loop, which goes on meanwhile.

        seen: the stops that the sender may have known of, those answered by now by default.
        """
        known = self.stop_order.known()  # now: later, in a pool, it may have become too late to ask
        seen = known if seen is None else min(seen, known)
        pool = self.opening if command.prepares else self.commands
        pool = self.fitting if command.waits else pool
        pool = self.stops if isinstance(command, Stop) else pool
        return await OffThread(pool, 409)(self.loop.submit, command, ANSWER_TIMEOUT, seen)

    async def apply(self, command: Command, request: Request | None = None) -> Result:
        """Submit for a request; 409 with `why` if the loop, or whoever holds control, refuses."""
        page = request.headers.get("x-studio-page") if request is not None else None
        why = "" if isinstance(command, Stop) else self.control.refusal(page)
        if why:
            raise refused(why)
        result = await self.submit(command, _stops_seen(request))
        if not result.ok:
            raise refused(result.why)
        return result

    def state(self) -> dict[str, Any]:
        """GET /api/state, with who holds control."""
        return {**self.loop.state_dict(), **NAMES, "control": self.control.state()}

    def state_json(self, **first: Any) -> bytes:
        """The same in JSON, after the keys of `first`.

        What the loop says is encoded once, however many pages look, ten times a second each.
        """
        state = self.loop.state_dict()
        if state is not self._encoded[0]:
            self._encoded = state, msgspec.json.encode(plain({**state, **NAMES}))
        ours = msgspec.json.encode({**first, "control": self.control.state()})
        return self._encoded[1][:-1] + b"," + ours[1:]

    def drive(self, page: str, keys: frozenset[str]) -> None:
        """Keys held by the page in control become what the hand-driven operator means."""
        if page == self.control.holder:
            self.loop.runtime.source.set_intent(intent_of(keys))

    def close(self) -> None:
        """Let no thread and no process linger."""
        for end in self.at_close:
            end()
        for pool in (self.stops, self.commands, self.workers, self.opening, self.fitting):
            pool.shutdown(wait=False, cancel_futures=True)


@dataclass(frozen=True)
class OffThread:
    """The one way off the event loop: work on the disk, or waiting, done by `workers` meanwhile.

    A StudioError becomes an answer: HTTPException with this status, or the call's own.
    """

    workers: Executor
    status: int

    async def __call__(
        self, work: Callable[..., T], *args: Any, status: int | None = None, **more: Any
    ) -> T:
        """What `work(*args, **more)` returns."""
        try:
            return await asyncio.get_running_loop().run_in_executor(
                self.workers, lambda: work(*args, **more)
            )
        except StudioError as error:
            raise refused(str(error), status or self.status) from error


def refused(why: str, status: int = 409) -> HTTPException:
    """An answer of {"why": …} with a status."""
    return HTTPException(status, detail=why)


def _stops_seen(request: Request | None) -> int | None:
    """How many stops its sender knew of at most: those known when it was received, and `stops` of
    the state that a page showed when its user pressed the button, if it says."""
    if request is None:
        return None
    said = request.headers.get("x-studio-stops", "")
    shown = [int(said)] if said.isascii() and said.isdigit() and len(said) < 10 else []
    received = request.scope.get("state", {}).get(STOPS_KNOWN)
    return min(shown if received is None else [*shown, received], default=None)
