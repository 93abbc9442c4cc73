"""The flow in real time: drain commands, read, step, record, publish, wait; 30 times a second."""

import gc
import logging
import sys
import threading
from collections import deque
from dataclasses import dataclass, field, replace
from typing import Any

from studio.errors import StudioError
from studio.live import commands as c
from studio.live.clock import Clock, Metronome, WallClock
from studio.live.faults import Faults
from studio.live.mailbox import BoundedQueue, Latest
from studio.live.runtime import Runtime, RuntimeConfig
from studio.live.state import latches, state_dict
from studio.sources import TakesNoFrames
from studio.takes.tick import Tick

log = logging.getLogger(__name__)

SWITCH_INTERVAL = 0.0005
"""s; Python's default of 5 ms makes a 30 Hz thread late beside busy ones (docs/findings.md)."""


@dataclass(kw_only=True)
class _Request:
    """A command on its way, and its answer on the way back.

    seen: how many stops had been answered when it was sent. prepared: what it needs to be applied.
    """

    command: c.Command
    seen: int
    prepared: Any = None
    done: threading.Event = field(default_factory=threading.Event)
    result: c.Result = field(default_factory=lambda: c.Result(ok=False, why="not answered"))


class LiveLoop:
    """One thread that owns the world, the networks and the recorder; others ask and look.

    `ticks` holds the newest Tick. `submit`, `post`, `beat`, `silent`, `push_frame` and `state_dict`
    may be called from any thread; `tick` is one period, for the loop's own thread or a test's
    fake clock.
    """

    def __init__(
        self,
        config: RuntimeConfig | None = None,
        clock: Clock | None = None,
        runtime: Runtime | None = None,
    ) -> None:
        self.runtime = runtime or Runtime(config or RuntimeConfig())
        self.clock = clock or WallClock()
        self.ticks: Latest[Tick] = Latest()
        self.period_error_ms: deque[float] = deque(maxlen=3000)
        self._metronome = Metronome(self.clock)
        self._requests: BoundedQueue[_Request] = BoundedQueue()
        self._stops: BoundedQueue[_Request] = BoundedQueue(4096)  # a stop finds room always
        self._stop_waits = threading.Event()
        self._refused = 0
        self.stops = 0
        """Stops answered so far, falls and faults among them: who sends a release says which of
        them were known by then."""
        self.faults = Faults(log)
        self._state: dict[str, Any] = {}
        self._running = threading.Event()
        self._thread: threading.Thread | None = None

    @property
    def config(self) -> RuntimeConfig:
        """Where takes are, and how to drive, as of now."""
        return self.runtime.config

    # From any thread ----------------------------------------------------------------------------

    def submit(self, command: c.Command, timeout: float = 8.0, seen: int | None = None) -> c.Result:
        """Have a command applied; waits until after the tick that did, at most `timeout` s.

        A stop is applied and answered between ticks as well; the next one damps the robot.
        What takes long (opening a source, reading a take) happens here, on the caller's thread.
        seen: `stops` when it was sent, now by default. What would release a stopped robot is
        refused where another stop came since: whatever was on its way, a stop that was answered
        holds.
        """
        seen = self.stops if seen is None else seen
        try:
            prepared = command.prepare(self.runtime)
        except StudioError as error:
            return c.Result(ok=False, why=str(error), state=self.state_dict())
        request = _Request(command=command, seen=seen, prepared=prepared)
        if not self._send(request):
            return c.Result(ok=False, why="too many commands wait: try again", state=self._state)
        if not request.done.wait(timeout):
            return c.Result(ok=False, why="the control loop did not answer", state=self._state)
        return request.result

    def post(self, command: c.Command) -> bool:
        """Have a command applied at the next tick, without waiting; False when too many wait."""
        return self._send(_Request(command=command, seen=self.stops))

    def _send(self, request: _Request) -> bool:
        if not isinstance(request.command, c.Stop):
            return self._requests.put(request)
        sent = self._stops.put(request)
        self._stop_waits.set()
        return sent

    def beat(self, page: str) -> None:
        """The page in control lives."""
        self.runtime.safety.beat(page, self.clock.now())

    def silent(self, page: str) -> bool:
        """The page held control and has gone silent."""
        return self.runtime.safety.silent(page, self.clock.now())

    def push_frame(self, raw: object) -> None:
        """One human frame for the source `stream`; StudioError says what is wrong with it."""
        try:
            self.runtime.source.push(raw)
        except TakesNoFrames:
            self._refused += 1
            raise

    def new_sender(self) -> None:
        """Another client starts to send frames: its skeleton and clock are its own."""
        self.runtime.source.new_sender()

    def state_dict(self) -> dict[str, Any]:
        """The object of GET /api/state, as of the last tick."""
        return self._state

    # The thread ---------------------------------------------------------------------------------

    def start(self) -> None:
        """Run in a thread of its own until `stop`."""
        self._running.set()
        self._thread = threading.Thread(target=self._run, name="control", daemon=True)
        self._thread.start()

    @property
    def alive(self) -> bool:
        """The thread runs."""
        return self._thread is not None and self._thread.is_alive()

    def stop(self) -> None:
        """End the thread, then the take and the source in good order. Idempotent."""
        self._running.clear()
        if self._thread is not None:
            self._thread.join(timeout=5.0)
            self._thread = None
            self.runtime.close()

    def _run(self) -> None:
        interval = sys.getswitchinterval()
        sys.setswitchinterval(SWITCH_INTERVAL)
        gc.collect()
        gc.freeze()
        gc.disable()  # collected in the slack of a period instead of in the midst of one
        self._metronome.reset()
        try:
            count = 0
            while self._running.is_set():
                self.tick()
                count += 1
                self._collect_garbage(count)
                self.wait()
        except Exception as error:
            self.faults.tell("the control loop ended", error)
        finally:
            gc.enable()
            gc.unfreeze()
            sys.setswitchinterval(interval)
            self._refuse_waiting()

    def wait(self) -> None:
        """Wait for the next deadline, counting lateness."""
        late, dropped = self._metronome.late, self._metronome.dropped
        error = self._metronome.wait(self._stop_waits, self._stop_now)
        if self._metronome.dropped > dropped:
            self.runtime.reader.slip(self._metronome.dropped - dropped)
        self.runtime.safety.period(late=self._metronome.late > late)
        self.period_error_ms.append(1e3 * abs(error))

    def tick(self) -> None:
        """One control period: commands, source, flow, record, publish, answers."""
        now = self.clock.now()
        # Stops last: nothing that was sent before or beside one may undo it.
        requests = self._requests.drain() + self._stops.drain()
        self._apply_all(requests, now)
        try:
            tick = self._with_loop_counters(self.runtime.step(now))
            self.ticks.publish(tick)
            self._state = state_dict(self.runtime, tick, now, self.period_error_ms)
        except Exception as error:
            self.faults.tell("a control period failed; the robot is stopped", error)
            if not self.runtime.safety.stopped:
                self.runtime.safety.stop(f"a fault: {error}", "fault")
            self._state = {**self._state, **latches(self.runtime.safety)}
        self._answer(requests)

    def _stop_now(self) -> None:
        """A stop does not wait for the next period to be answered, only to be acted on."""
        stops = self._stops.drain()
        self._apply_all(stops, self.clock.now())
        self._state = {**self._state, **latches(self.runtime.safety)}
        self._answer(stops)

    def _answer(self, requests: list[_Request]) -> None:
        self.stops = self.runtime.safety.stops
        for request in requests:
            request.result = replace(request.result, state=self._state)
            request.done.set()

    def _apply_all(self, requests: list[_Request], now: float) -> None:
        for request in requests:
            request.result = self._apply(request, now)

    def _apply(self, request: _Request, now: float) -> c.Result:
        command = request.command
        if command.releases and request.seen < self.runtime.safety.stops:
            return c.Result(ok=False, why="a stop came after this was sent: send it again")
        try:
            return c.Result(ok=True, data=command.apply(self.runtime, now, request.prepared))
        except StudioError as error:
            return c.Result(ok=False, why=str(error))
        except Exception as error:
            log.exception("command %s failed", command)
            return c.Result(ok=False, why=f"{type(command).__name__} failed: {error}")

    def _with_loop_counters(self, tick: Tick) -> Tick:
        counters = dict(tick.counters)
        counters["rejected"] += self._refused
        counters["late"] = self._metronome.late
        return replace(tick, counters=counters)

    def _collect_garbage(self, count: int) -> None:
        """Garbage, a little in every slack: young objects each second, all of them each minute."""
        if count % 30 == 0:
            gc.collect(2 if count % 1800 == 0 else 1)

    def _refuse_waiting(self) -> None:
        for request in self._stops.drain() + self._requests.drain():
            request.result = c.Result(ok=False, why="the studio is closing")
            request.done.set()
