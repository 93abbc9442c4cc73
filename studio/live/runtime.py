"""What the control loop owns and commands act on: source, puppeteer, safety, recorder, replay."""

import logging
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from studio.control.drive_command import DriveCommand, PuppeteerConfig, Reason
from studio.errors import StudioError
from studio.human.calibration import Calibration, calibrate
from studio.link.link import RobotLink
from studio.live import robot_watch
from studio.live.best_runs import Props, SceneRuns
from studio.live.collect_stages import Step
from studio.live.collecting import Collector
from studio.live.mappers import Mappers
from studio.live.replay import Replay
from studio.live.safety import Safety
from studio.live.seek_guard import SeekGuard
from studio.live.source_reader import OpenedSource, ReplacedSource, SourceReader, open_for
from studio.puppeteer import Puppeteer
from studio.reference.intent import StateName
from studio.robot.pose import ReferencePose
from studio.sources import Source
from studio.takes.record.recorder import Recorder
from studio.takes.tick import Tick

log = logging.getLogger(__name__)

_ENDED = "the source has ended: play it again, or choose mode live and then who else acts"


@dataclass(frozen=True, kw_only=True)
class RuntimeConfig:
    """source: a spec of docs/contract.md. sessions: where takes are. puppeteer: how to drive."""

    source: str = "operator"
    sessions: Path = Path("sessions")
    puppeteer: PuppeteerConfig = field(default_factory=PuppeteerConfig)


class Runtime:
    """One studio's state. Only the loop's thread calls it (`step`, and each command's `apply`)."""

    def __init__(
        self,
        config: RuntimeConfig,
        opened: OpenedSource | None = None,
        puppeteer: Puppeteer | None = None,
        link: RobotLink | None = None,
    ) -> None:
        self.config = config
        opened = opened or open_for(config.source, config.puppeteer, config.sessions)
        self.puppeteer = puppeteer or Puppeteer(config.puppeteer, opened.calibration, link=link)
        self.reader = SourceReader(opened.source)
        live = robot_watch.begins_live(self.puppeteer, opened.source)
        self.safety = Safety(armed=live)
        self.mode = "live" if live else "idle"
        self.idle_by_source = not live  # nobody asked for idle: arming is enough to go live
        self.seek_guard = SeekGuard(self.reader, self.puppeteer, self.safety)
        self.recorder = Recorder(config.sessions)
        self.replay: Replay | None = None
        self.collector = Collector(config.sessions, self.recorder)
        self.mappers = Mappers(self.puppeteer.retargeter.experts)
        self.replaced, self.runs = ReplacedSource(), SceneRuns(config.sessions)
        self.last_take: str | None = None
        self.reason: Reason = ""  # for the last tick's `why`
        self.props: Props = None  # beside the last tick's robot
        self._replayed = 0

    @property
    def source(self) -> Source:
        """Where human motion comes from now."""
        return self.reader.source

    # What commands ask of more than one of them -------------------------------------------------

    def enter(self, mode: str, now: float) -> None:
        """Change the mode. StudioError where there is nothing to replay, or a take is recorded."""
        if mode == "replay" and self.replay is None:
            raise StudioError("nothing to replay: record a take, or choose the source take:NAME")
        if mode == "replay" and self.mode != "collect":
            self.collector.refuse_while_recording()  # nothing of a replay would be recorded
        if mode != "collect":
            self.leave_collect(now)
        self.mode, self.idle_by_source = mode, False
        if mode in ("live", "collect"):
            self.puppeteer.rejoin()

    # One control period -------------------------------------------------------------------------

    def step(self, now: float) -> Tick:
        """Read the source, drive the robot (or replay), record. `now`: s on the loop's clock."""
        if self.mode == "replay" and self.replay is not None:
            tick, self.props = self.replay.step(), None
            self._replayed += tick.human_fresh
            robot_watch.rest_meanwhile(self.puppeteer, self.safety, now)
            paused: Reason = "paused" if tick.why else ""
            self.reason = self.safety.reason or paused
            return replace(tick, counters=self.counters(), why=self.safety.stop_line or tick.why)
        self._stand_up_if_demo(now)
        shown, collecting = self._collect()
        human = self.seek_guard.read(now, recording=self.recorder.recording is not None)

        def command(age: float) -> DriveCommand:
            if age == 0.0:
                self.safety.see(now)
            return self.safety.command(
                now, self.mode, source_ended=self.reader.ended, keep=self.seek_guard.keep
            )

        try:
            tick = self.puppeteer.step(human, command, shown)
        except Exception as error:
            self.safety.stop(f"a fault: {error}", "fault")
            self.puppeteer.place("stand")
            raise
        self.props = self.runs.watch(self.puppeteer.stage, self.source.name)
        self.reason = self.puppeteer.reason
        robot_watch.watch(self.puppeteer, self.safety)
        if tick.fallen and not self.safety.stopped:
            self.safety.fall(now, demo=self._demo)
            self.reason = self.safety.reason
            tick = replace(tick, why=self.safety.stop_line)
        tick = replace(tick, counters=self.counters())
        if collecting is not None:
            self.collector.write(collecting, self.about(), self._calibration())
        self._record(tick)
        return tick

    def counters(self) -> dict[str, int]:
        """Totals since the start."""
        own = self.puppeteer.counters
        rejected = own["rejected"] + self.reader.rejected
        return {
            **own,
            "frames": own["frames"] + self._replayed,
            "rejected": rejected,
            "falls": self.safety.falls,
        }

    @property
    def _demo(self) -> bool:
        """Nobody drives, and nobody can be hurt."""
        drives_nobody = self.mode == "live" and self.source.tours
        return drives_nobody and self.puppeteer.link.simulated

    def _stand_up_if_demo(self, now: float) -> None:
        if self.safety.rises(now, demo=self._demo):
            self.puppeteer.stand_up()
            self.safety.reset()
            self.safety.arm(now)
            self.puppeteer.rejoin()

    def watch(self, opened: OpenedSource, now: float, played: float = 0.0) -> None:
        """Another person from here on, whose source began `played` s ago."""
        self.reader.use(opened.source, now, played)
        self.puppeteer.forget_person(opened.calibration)
        self.safety.forget_person()

    @property
    def recording_error(self) -> str | None:
        """Why the last take ended early or was not indexed; None when nothing is wrong."""
        return self.recorder.problem

    def walk_in(self, style: str) -> None:
        """Walking means `style` to whoever is watched next, and to the built-in operator now."""
        self.config = replace(self.config, puppeteer=replace(self.config.puppeteer, style=style))
        for source in (self.source, self.replaced.waiting):
            if source is not None:
                source.set_style(style)

    def about(self) -> dict[str, Any]:
        """What a take's meta.json tells of how it came about."""
        puppeteer = self.puppeteer
        return {
            "source": self.source.name,
            "style": puppeteer.config.style,
            "controller": puppeteer.controller.name,
            "mirror": puppeteer.config.mirror,
            "scene": puppeteer.stage.name,
        }

    def _calibration(self) -> Calibration:
        return self.puppeteer.retargeter.extractor.calibration

    # Collecting ---------------------------------------------------------------------------------

    def _collect(self) -> tuple[tuple[StateName, ReferencePose] | None, Step | None]:
        """In mode collect: what is shown in this period, to the person too, and the plan's step."""
        if self.mode != "collect":
            return None, None
        if self.reader.ended:
            self.collector.nobody_acts(_ENDED)
        elif self.collector.why == _ENDED:
            self.collector.why = ""
        machine = self.puppeteer.state_machine
        shown, step = self.collector.step(machine.reference, machine.facing, not machine.following)
        if step.event == "start":
            self.puppeteer.align_robot_to_reference()
        self.source.show(shown.intent)
        return (shown.state, shown.pose), step

    def enter_collect(self, operator: OpenedSource | None, now: float) -> None:
        """Mode collect; operator: acts in place of the built-in one. StudioError while a take is
        recorded."""
        if self.mode == "collect":
            return
        self.collector.refuse_while_recording()
        if operator is not None:
            self.replaced.enter(self.source, self.reader.played(now))
            self.watch(operator, now)
        self.enter("collect", now)

    def leave_collect(self, now: float) -> None:
        """Back to the person there was before, who goes on; a running take is thrown away."""
        if self.mode != "collect":
            return
        self.collector.abort("collecting was left: the take was thrown away")
        before = self.replaced.leave()
        if before is not None:
            source, played = before
            self.reader.close()
            calibration = calibrate(source.calibration_poses())
            self.watch(OpenedSource(source=source, calibration=calibration), now, played)

    def _record(self, tick: Tick) -> None:
        if self.recorder.recording is None:
            return
        try:
            self.recorder.append(tick)
        except StudioError as error:  # the recorder has closed the take and keeps what it has
            log.error("%s", error)

    def close(self) -> None:
        """End a take in good order, free the source and the robot."""
        self.replaced.forget()
        self.mappers.fitting.cancel()
        self.recorder.close()
        self.runs.close()
        self.collector.close()
        self.reader.close()
        self.puppeteer.link.close()
