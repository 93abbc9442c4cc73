"""What the control loop owns and commands act on: source, puppeteer, safety, recorder, replay."""

import logging
from dataclasses import dataclass, field, replace
from functools import singledispatchmethod
from pathlib import Path
from typing import Any

from studio.errors import StudioError, unknown_name
from studio.human.calibration import Calibration, calibrate
from studio.human.pose import HumanPose
from studio.live import commands as c
from studio.live.replay import Replay
from studio.live.safety import Safety, Situation
from studio.mocap import Source, SourceEnded, open_source
from studio.puppeteer import Puppeteer, PuppeteerConfig
from studio.recording.names import take_folder
from studio.recording.recorder import Recorder
from studio.recording.take import read_take
from studio.recording.tick import Tick

log = logging.getLogger(__name__)


@dataclass(frozen=True, kw_only=True)
class SessionConfig:
    """source: a spec of contract.md. sessions: where takes are. puppeteer: how to drive."""

    source: str = "operator"
    sessions: Path = Path("sessions")
    puppeteer: PuppeteerConfig = field(default_factory=PuppeteerConfig)


@dataclass(frozen=True, kw_only=True)
class OpenedSource:
    """A source and what scanning it ahead told of the person; made by any thread."""

    source: Source
    calibration: Calibration


@dataclass(frozen=True, kw_only=True)
class OpenedReplay:
    """A take read for replay; made by any thread."""

    replay: Replay


def open_for(config: SessionConfig, spec: str) -> OpenedSource:
    """Open and scan a source, which may take a while: never on the loop's thread."""
    source = open_source(
        spec, seed=config.puppeteer.seed, style=config.puppeteer.style, sessions=config.sessions
    )
    return OpenedSource(source=source, calibration=calibrate(source.calibration_poses()))


def open_replay(config: SessionConfig, name: str) -> OpenedReplay:
    """Read a take's ticks. StudioError if there is none of that name."""
    ticks = read_take(take_folder(config.sessions, name)).ticks
    return OpenedReplay(replay=Replay(name, ticks))


class Session:
    """One studio's state. Only the loop's thread calls it (`apply`, `step`)."""

    def __init__(
        self,
        config: SessionConfig,
        opened: OpenedSource | None = None,
        puppeteer: Puppeteer | None = None,
    ) -> None:
        self.config = config
        opened = opened or open_for(config, config.source)
        self.puppeteer = puppeteer or Puppeteer(config.puppeteer, opened.calibration)
        self.source = opened.source
        self.safety = Safety(armed=self.source.starts_live)
        self.mode = "live" if self.source.starts_live else "idle"
        self.recorder = Recorder(config.sessions)
        self.recorded = 0  # ticks of the take being recorded
        self.replay: Replay | None = None
        self.last_take: str | None = None
        self.scene = "empty"
        self._idle_by_source = not self.source.starts_live
        self._source_from: float | None = None  # the loop's time at the source's start
        self._human_at: float | None = None
        self._ended = False
        self._replayed = 0
        self._refused = 0  # by sources that were since closed

    # One control period -------------------------------------------------------------------------

    def step(self, now: float, overrun: bool = False) -> Tick:
        """Read the source, drive the robot (or replay), record. `now`: s on the loop's clock."""
        if self.mode == "replay" and self.replay is not None:
            tick = self.replay.step()
            self._replayed += tick.human_fresh
            return replace(tick, counters=self.counters())
        human = self._read(now)
        orders = self.safety.orders(
            Situation(
                now=now,
                mode=self.mode,
                human_at=self._human_at,
                source_ended=self._ended,
                overrun=overrun,
            )
        )
        try:
            tick = self.puppeteer.step(human, orders)
        except Exception as error:
            log.exception("control period failed")
            self.safety.stop(f"a fault: {error}")
            self.puppeteer.place("stand")
            raise
        if tick.fallen and not self.safety.stopped:
            self.safety.stop("the robot fell")
        tick = replace(tick, counters=self.counters())
        self._record(tick)
        return tick

    def counters(self) -> dict[str, int]:
        """Totals since the start."""
        own = self.puppeteer.counters
        rejected = own["rejected"] + self.source.rejected + self._refused
        return {**own, "frames": own["frames"] + self._replayed, "rejected": rejected}

    def _read(self, now: float) -> HumanPose | None:
        if self._source_from is None:
            self._source_from = now
        if self._ended:
            return None
        try:
            human = self.source.read(now - self._source_from)
        except SourceEnded:
            self._ended = True
            return None
        except Exception:
            log.exception("the source failed; the robot stands")
            self._ended = True
            return None
        if human is not None:
            self._human_at = now
        return human

    def _record(self, tick: Tick) -> None:
        if self.recorder.recording is None:
            return
        try:
            self.recorder.append(tick)
            self.recorded += 1
        except StudioError as error:  # the recorder has closed the take and keeps what it has
            log.error("%s", error)

    # Commands -----------------------------------------------------------------------------------

    @singledispatchmethod
    def apply(self, command: Any, now: float) -> dict[str, Any]:
        """Do what a command asks; StudioError says why not. Returns what it made, if anything."""
        raise StudioError(f"unknown command {type(command).__name__}")

    @apply.register
    def _(self, command: c.SetMode, now: float) -> dict[str, Any]:
        if command.mode not in c.MODES:
            raise unknown_name("mode", command.mode, c.MODES)
        if command.mode == "collect":
            raise StudioError(
                "collecting takes by prompt is not part of this version: record "
                "in mode live with takes/start"
            )
        if command.mode == "replay" and self.replay is None:
            raise StudioError("nothing to replay: record a take, or choose the source take:NAME")
        self.mode = command.mode
        self._idle_by_source = False
        if self.mode == "live":
            self.puppeteer.rejoin()
        return {}

    @apply.register
    def _(self, command: OpenedReplay, now: float) -> dict[str, Any]:
        self.replay = command.replay
        return self.apply(c.SetMode(mode="replay"), now)

    @apply.register
    def _(self, command: c.SetStateLock, now: float) -> dict[str, Any]:
        self.puppeteer.lock_state(command.state)
        return {}

    @apply.register
    def _(self, command: OpenedSource, now: float) -> dict[str, Any]:
        self._refused += self.source.rejected
        self.source.close()
        self.source = command.source
        self.puppeteer.forget_person(command.calibration)
        self._source_from, self._human_at, self._ended = now, None, False
        live = self.source.starts_live
        self.mode, self._idle_by_source = ("live" if live else "idle"), not live
        if not self.safety.stopped:
            self.safety.armed = live
        return {}

    @apply.register
    def _(self, command: c.Stop, now: float) -> dict[str, Any]:
        self.safety.stop(f"emergency stop by {command.by}")
        if self.replay is not None:
            self.replay.playing = False
        return {}

    @apply.register
    def _(self, command: c.Reset, now: float) -> dict[str, Any]:
        self.puppeteer.stand_up()
        self.safety.reset()
        return {}

    @apply.register
    def _(self, command: c.Arm, now: float) -> dict[str, Any]:
        why = self.safety.arm(now)
        if why:
            raise StudioError(why)
        if self.mode == "idle" and self._idle_by_source:
            self.mode, self._idle_by_source = "live", False
        self.puppeteer.rejoin()
        return {}

    @apply.register
    def _(self, command: c.Disarm, now: float) -> dict[str, Any]:
        self.safety.disarm()
        return {}

    @apply.register
    def _(self, command: c.SetGain, now: float) -> dict[str, Any]:
        self.puppeteer.set_gain(command.name, command.value)
        return {}

    @apply.register
    def _(self, command: c.SetController, now: float) -> dict[str, Any]:
        self.puppeteer.set_controller(command.name)
        return {}

    @apply.register
    def _(self, command: c.SetMirror, now: float) -> dict[str, Any]:
        self.puppeteer.set_mirror(command.mirror)
        return {}

    @apply.register
    def _(self, command: c.Calibrate, now: float) -> dict[str, Any]:
        self.puppeteer.calibrate_now()
        return {}

    @apply.register
    def _(self, command: c.TakeControl, now: float) -> dict[str, Any]:
        self.safety.take_control(command.page, now)
        return {}

    @apply.register
    def _(self, command: c.ReleaseControl, now: float) -> dict[str, Any]:
        self.safety.release_control(command.page)
        return {}

    @apply.register
    def _(self, command: c.Seek, now: float) -> dict[str, Any]:
        if self.replay is None:
            raise StudioError("nothing is replayed: choose mode replay first")
        self.replay.seek(command.t, command.playing, command.speed)
        return {}

    @apply.register
    def _(self, command: c.StartTake, now: float) -> dict[str, Any]:
        puppeteer = self.puppeteer
        about = {
            "source": self.source.name,
            "style": puppeteer.config.style,
            "controller": puppeteer.tracker.name,
            "mirror": puppeteer.config.mirror,
        }
        name = self.recorder.start(command.label, name=command.name, about=about)
        self.recorded = 0
        return {"name": name}

    @apply.register
    def _(self, command: c.StopTake, now: float) -> dict[str, Any]:
        stopped = self.recorder.stop()
        self.last_take = stopped["name"]
        return stopped

    def close(self) -> None:
        """End a take in good order and free the source."""
        self.recorder.close()
        self.source.close()
