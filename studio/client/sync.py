"""A studio, frames in and ticks out, for plain programs: every call waits for its answer."""

import asyncio
import threading
from collections.abc import Coroutine, Iterator, Sequence
from pathlib import Path
from typing import Any, Generic, Self, TypeVar, Unpack

from studio.client.async_sockets import AsyncFrames, AsyncSocket, AsyncTicks
from studio.client.http import Address, ClientError, Options, take_path
from studio.client.messages import (
    Format,
    Mode,
    Point,
    Skeleton,
    State,
    StateLock,
    StoppedTake,
    Take,
    Tick,
    TransportAction,
)

S = TypeVar("S", bound=AsyncSocket)
T = TypeVar("T")


class Studio:
    """A running `a1-studio serve`; any thread may call it. See `Address` for the arguments.

    Each method returns once the control loop has done what it asks; ClientError says why it
    has not.
    """

    def __init__(self, url: str, token: str | None = None, **options: Unpack[Options]) -> None:
        self.address = Address(url, token, **options)

    def state(self) -> State:
        """What it is doing."""
        return self.address.ask("GET", "/api/state")

    def set_mode(self, mode: Mode) -> State:
        """Rest, follow the source, show a take again, or collect."""
        return self.address.ask("POST", "/api/mode", {"mode": mode})

    def lock_state(self, state: StateLock) -> State:
        """Stay in a state; "auto" lets the person's motion choose."""
        return self.address.ask("POST", "/api/state", {"state": state})

    def set_source(self, source: str) -> State:
        """Where human motion comes from: "stream" for frames of ours, "bvh:FILE" …"""
        return self.address.ask("POST", "/api/source", {"source": source})

    def set_scene(self, scene: str) -> State:
        """What stands around the robot."""
        return self.address.ask("POST", "/api/scene", {"scene": scene})

    def stop(self) -> State:
        """Emergency stop: it stays stopped until reset and armed."""
        return self.address.ask("POST", "/api/stop")

    def reset(self) -> State:
        """Stand up again, which takes up to 3 s; still stopped."""
        return self.address.ask("POST", "/api/reset")

    def arm(self) -> State:
        """Follow the person, from now on."""
        return self.address.ask("POST", "/api/arm")

    def transport(self, action: TransportAction, **more: float | bool) -> State:
        """Move in a clip or a take: `position_s` with "seek", `frames` with "step", `speed`, and
        `on` with "loop"."""
        return self.address.ask("POST", "/api/transport", {"action": action, **more})

    def takes(self) -> list[Take]:
        """All takes."""
        return self.address.ask("GET", "/api/takes")

    def take(self, name: str) -> Take:
        """One of them."""
        return self.address.ask("GET", take_path(name))

    def start_take(self, label: str = "") -> str:
        """Record from the next tick on; the take's name."""
        return self.address.ask("POST", "/api/takes/start", {"label": label})["name"]

    def stop_take(self) -> StoppedTake:
        """End the take that records."""
        return self.address.ask("POST", "/api/takes/stop")

    def edit_take(
        self,
        name: str,
        *,
        label: str | None = None,
        trim: tuple[float, float] | None = None,
        lag: float | None = None,
        keep: bool | None = None,
    ) -> Take:
        """Change what is not None. trim: (from, to) s on the tape. lag: s, robot behind person."""
        asked = {"label": label, "trim": trim, "lag": lag, "keep": keep}
        changes = {key: value for key, value in asked.items() if value is not None}
        return self.address.ask("PATCH", take_path(name), changes)

    def undo_take(self, name: str) -> Take:
        """Take its last edit back."""
        return self.address.ask("POST", take_path(name, "undo"))

    def delete_take(self, name: str) -> None:
        """Into the bin."""
        self.address.ask("DELETE", take_path(name))

    def export_take(self, name: str, format: Format, to: str | Path) -> Path:
        """Write the take as a file of that format to `to`."""
        return self.address.download(take_path(name, f"export?format={format}"), Path(to))

    def frames(self) -> "Frames":
        """A way in for human frames; the source has to be "stream" or "webcam"."""
        return Frames(self.address)

    def ticks(self) -> "Ticks":
        """Ticks as they happen, 30 a second."""
        return Ticks(self.address)


class _Socket(Generic[S]):
    """One WebSocket, opened here; closed by `close` or at the end of a `with`.

    It is an asyncio one on a thread of its own: websockets' own for threads reads and writes from
    two, which one TLS connection does not bear before Python 3.13 (1 in 60 was never answered).
    """

    def __init__(self, socket: S) -> None:
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever, daemon=True)
        self._thread.start()
        self._socket, self._open = socket, True
        try:
            self._wait(socket.__aenter__())
        except BaseException:
            self._end()
            raise

    def close(self) -> None:
        """Leave; idempotent."""
        if self._open:
            try:
                self._wait(self._socket.__aexit__())
            finally:
                self._end()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _wait(self, made: Coroutine[Any, Any, T]) -> T:
        if not self._open:
            made.close()
            raise ClientError("this connection was closed here")
        return asyncio.run_coroutine_threadsafe(made, self._loop).result()

    def _end(self) -> None:
        self._open = False
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join()
        self._loop.close()


class Frames(_Socket[AsyncFrames]):
    """Sends human frames."""

    def __init__(self, address: Address) -> None:
        super().__init__(AsyncFrames(address))

    @property
    def refused(self) -> int:
        """How many frames the studio said it cannot use, as far as heard."""
        return self._socket.refused

    def send(
        self,
        t: float,
        skeleton: Skeleton,
        positions: Sequence[Point],
        confidence: Sequence[float] | None = None,
    ) -> list[str]:
        """Send one frame; what was wrong with earlier ones, which only bad ones are answered.

        t: s by the sender's clock. positions: (joints, 3) m in the skeleton's axes and order, None
        for a joint not seen. confidence: (joints,), 0 not seen. ClientError when disconnected.
        """
        return self._wait(self._socket.send(t, skeleton, positions, confidence))

    def errors(self, timeout: float = 0.0) -> list[str]:
        """What was wrong with frames sent, not told before; waits `timeout` s for the first."""
        return self._wait(self._socket.errors(timeout))


class Ticks(_Socket[AsyncTicks]):
    """Iterates over ticks; ends when the studio does. Who is slow misses some (see `index`)."""

    def __init__(self, address: Address) -> None:
        super().__init__(AsyncTicks(address))

    def __iter__(self) -> Iterator[Tick]:
        while True:
            try:
                tick = self.next()
            except ClientError:
                return
            yield tick

    def next(self, timeout: float | None = None) -> Tick:
        """The next tick; ClientError where none comes within `timeout` s, or ever."""
        return self._wait(self._socket.next(timeout))
