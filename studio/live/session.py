"""What the control loop owns and commands act on: source, puppeteer, safety, recorder, replay."""

import logging
from dataclasses import dataclass, field, replace
from functools import singledispatchmethod
from pathlib import Path
from typing import TYPE_CHECKING, Any

from studio.errors import StudioError, unknown_name
from studio.human.calibration import Calibration, calibrate
from studio.human.pose import HumanPose
from studio.live import commands as c
from studio.live.collect import CollectPlan, Slot, Step
from studio.live.collecting import Acting, Collector
from studio.live.mappers import Mappers, OpenedMapper
from studio.live.replay import Replay
from studio.live.safety import Safety, Situation
from studio.mocap import Source, SourceEnded, open_source
from studio.mocap.follower import FollowingOperator
from studio.puppeteer import Puppeteer, PuppeteerConfig
from studio.recording.names import take_folder
from studio.recording.recorder import Recorder
from studio.recording.take import read_take
from studio.recording.tick import Tick
from studio.reference.intent import StateName
from studio.robot.pose import ReferencePose

if TYPE_CHECKING:
    from studio.live.playback import Playback

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

    replay: "Replay | Playback"


@dataclass(frozen=True, kw_only=True)
class OpenedCollect:
    """Mode collect, with the person who acts for the built-in operator; made by any thread."""

    operator: OpenedSource | None


@dataclass(frozen=True, kw_only=True)
class DrawnPlan:
    """A plan and the motions drawn for it; made by any thread."""

    plan: CollectPlan
    slots: list[Slot]


@dataclass(frozen=True, kw_only=True)
class DrawnMore:
    """More motions for the plan; made by any thread."""

    slots: list[Slot]


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


def follower_for(config: SessionConfig, source: Source) -> OpenedSource | None:
    """The synthetic person who acts out what is shown, if the source is the built-in operator."""
    if not source.name.startswith("operator") or isinstance(source, FollowingOperator):
        return None
    puppeteer = config.puppeteer
    person = FollowingOperator(seed=puppeteer.seed, style=puppeteer.style)
    return OpenedSource(source=person, calibration=calibrate(person.calibration_poses()))


def open_take(config: SessionConfig, command: c.ShowTake) -> OpenedReplay:
    """A take for review, as its edits leave it. StudioError if there is none of that name."""
    from studio.live.playback import Playback
    from studio.recording.review import open_table

    table, edits = open_table(config.sessions, command.name)
    playback = Playback(command.name, table, edits, aligned=command.aligned)
    playback.seek(command.t, command.playing, command.speed, command.loop)
    return OpenedReplay(replay=playback)


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
        self.replay: Replay | Playback | None = None
        self.collector = Collector(config.sessions, self.recorder)
        self.mappers = Mappers(self.puppeteer.retargeter.experts)
        self._acting = Acting()
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
        shown, collecting = self._collect()
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
            tick = self.puppeteer.step(human, orders, shown)
        except Exception as error:
            log.exception("control period failed")
            self.safety.stop(f"a fault: {error}")
            self.puppeteer.place("stand")
            raise
        if tick.fallen and not self.safety.stopped:
            self.safety.stop("the robot fell")
        tick = replace(tick, counters=self.counters())
        if collecting is not None:
            self.collector.write(collecting, self._about(), self._calibration())
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

    def _use(self, source: Source, calibration: Calibration, now: float) -> None:
        self.source = source
        self.puppeteer.forget_person(calibration)
        self._source_from, self._human_at, self._ended = now, None, False

    def _about(self) -> dict[str, Any]:
        """What a take's meta.json tells of how it came about."""
        puppeteer = self.puppeteer
        return {
            "source": self.source.name,
            "style": puppeteer.config.style,
            "controller": puppeteer.tracker.name,
            "mirror": puppeteer.config.mirror,
        }

    def _calibration(self) -> Calibration:
        return self.puppeteer.retargeter.extractor.calibration

    # Collecting ---------------------------------------------------------------------------------

    def _collect(self) -> tuple[tuple[StateName, ReferencePose] | None, Step | None]:
        """In mode collect: what is shown in this period, to the person too, and the plan's step."""
        if self.mode != "collect":
            return None, None
        controller = self.puppeteer.controller
        shown, step = self.collector.step(
            controller.reference, controller.facing, not controller.following
        )
        show = getattr(self.source, "show", None)
        if show is not None:
            show(shown.intent)
        return (shown.state, shown.pose), step

    def _leave_collect(self, now: float) -> None:
        if self.mode != "collect":
            return
        self.collector.abort("collecting was left: the take was thrown away")
        before = self._acting.leave()
        if before is not None:
            source, played = before
            self.source.close()
            self._use(source, calibrate(source.calibration_poses()), now)
            self._source_from = now - played

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
        if command.mode == "replay" and self.replay is None:
            raise StudioError("nothing to replay: record a take, or choose the source take:NAME")
        if command.mode != "collect":
            self._leave_collect(now)
        self.mode = command.mode
        self._idle_by_source = False
        if self.mode in ("live", "collect"):
            self.puppeteer.rejoin()
        return {}

    @apply.register
    def _(self, command: OpenedCollect, now: float) -> dict[str, Any]:
        if self.mode == "collect":
            return {}
        if self.recorder.recording is not None:
            raise StudioError(f"take {self.recorder.recording} is being recorded: stop it first")
        if command.operator is not None:
            played = now - (now if self._source_from is None else self._source_from)
            self._acting.enter(self.source, played)
            self._use(command.operator.source, command.operator.calibration, now)
        return self.apply(c.SetMode(mode="collect"), now)

    @apply.register
    def _(self, command: DrawnPlan, now: float) -> dict[str, Any]:
        self.collector.begin(command.plan, command.slots)
        return {}

    @apply.register
    def _(self, command: DrawnMore, now: float) -> dict[str, Any]:
        self.collector.machine.add(command.slots)
        return {}

    @apply.register
    def _(self, command: c.CollectAction, now: float) -> dict[str, Any]:
        if self.mode != "collect":
            raise StudioError("nothing is collected: choose mode collect first")
        return self.collector.act(command.action)

    @apply.register
    def _(self, command: OpenedMapper, now: float) -> dict[str, Any]:
        self.mappers.swap(command)
        self.puppeteer.set_experts(command.experts)
        return {"name": command.name or "shipped"}

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
        self.collector.abort("another source was chosen")
        self._acting.forget()
        self._refused += self.source.rejected
        self.source.close()
        self._use(command.source, command.calibration, now)
        live = self.source.starts_live
        self.mode, self._idle_by_source = ("live" if live else "idle"), not live
        if not self.safety.stopped:
            self.safety.armed = live
        return {}

    @apply.register
    def _(self, command: c.Stop, now: float) -> dict[str, Any]:
        self.safety.stop(f"emergency stop by {command.by}")
        self.collector.abort("stopped: the take was thrown away")
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
        self.replay.seek(command.t, command.playing, command.speed, command.loop)
        return {}

    @apply.register
    def _(self, command: c.StartTake, now: float) -> dict[str, Any]:
        name = self.recorder.start(command.label, name=command.name, about=self._about())
        self.recorded = 0
        return {"name": name}

    @apply.register
    def _(self, command: c.StopTake, now: float) -> dict[str, Any]:
        if self.mode == "collect":
            raise StudioError("the take belongs to the plan: abort it, or let it end")
        stopped = self.recorder.stop()
        self.last_take = stopped["name"]
        return stopped

    def close(self) -> None:
        """End a take in good order and free the source."""
        self._acting.forget()
        self.recorder.close()
        self.collector.close()
        self.source.close()
