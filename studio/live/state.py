"""The loop as the object of GET /api/state: what it does, and why nothing moves if nothing does.

KEYS is the one table of what it says; the schema, the pages' message and their types derive from it
(`web.answers`).
"""

from collections import deque
from collections.abc import Callable
from dataclasses import asdict, dataclass
from functools import cached_property
from itertools import islice
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import numpy as np

from studio.control.drive_command import Reason
from studio.link.remote import SILENT
from studio.live.command import OneOf
from studio.live.commands import transport
from studio.live.state_parts import (
    Arrivals,
    Calibration,
    Collect,
    Controller,
    Following,
    MapperInUse,
    Played,
    Recording,
    Replay,
    RobotBehind,
    SourceReport,
    Style,
)
from studio.live.tick_message import Mode, Pose, TickMessage
from studio.options import Steps
from studio.reference.intent import STATES
from studio.scenes.stage import Progress
from studio.statistics import percentiles
from studio.takes.as_json import part
from studio.takes.tick import Tick

if TYPE_CHECKING:
    from studio.live.runtime import Runtime
    from studio.live.safety import Safety

WINDOW = 300
"""Control periods over which the loop's punctuality is told: 10 s."""


@dataclass(frozen=True, kw_only=True)
class Seen:
    """What the state is read off. now: s on the loop's clock."""

    runtime: "Runtime"
    tick: Tick
    now: float
    period_error_ms: deque[float]

    @cached_property
    def tick_message(self) -> dict[str, Any]:
        """The tick as the sockets send it."""
        return part("tick", self.tick, "json")

    def stale_s(self) -> float | None:
        """Age of the last human pose; None before the first."""
        stale = self.runtime.safety.stale_s(self.now)
        return None if stale is None else round(stale, 3)

    def punctuality(self) -> dict[str, float]:
        """How late periods began, ms."""
        late = list(islice(reversed(self.period_error_ms), WINDOW)) or [0.0]
        return {name: round(ms, 3) for name, ms in percentiles(late).items()}

    def source_report(self) -> dict[str, Any]:
        """What was found in the source, and what was refused since."""
        refused = self.runtime.puppeteer.person.refused
        return self.runtime.source.report.and_refused(refused).as_dict()

    def arrivals(self) -> Arrivals | None:
        """How live frames come of late."""
        found = self.runtime.source.arrivals
        return None if found is None else Arrivals(**asdict(found))

    def calibration(self) -> Calibration:
        """Of the person."""
        extractor = self.runtime.puppeteer.retargeter.extractor
        return Calibration(
            heading_deg=round(float(np.degrees(extractor.calibrator.heading)), 1),
            leg_length_m=round(extractor.calibration.leg_length, 3),
            seconds=round(extractor.calibration.seconds, 1),
        )

    def travel(self) -> Following:
        """Whether the robot walks beside the person."""
        puppeteer = self.runtime.puppeteer
        return Following(
            mode=puppeteer.config.travel,
            found=puppeteer.retargeter.path.found,
            moving=puppeteer.retargeter.travels,
        )

    def recording(self) -> Recording | None:
        """The take being written."""
        name = self.runtime.recorder.recording
        return None if name is None else Recording(name=name, ticks=self.runtime.recorder.ticks)

    def link(self) -> RobotBehind | None:
        """The robot that is not simulated here, as it last told."""
        link = self.runtime.puppeteer.link
        if (told := link.told) is None:
            return None
        return RobotBehind(
            name=link.name,
            level=link.level,
            phase=told.phase,
            why=told.why,
            heard_s=round(told.heard_s, 3),
            silent=told.heard_s > SILENT,
            refused=told.refused,
        )

    def props(self) -> dict[str, list[float]]:
        """Of each prop that has a body: x, y, z (m), and its orientation (wxyz), world."""
        shown = self.runtime.props
        if shown is None:
            return {}
        scene, at = shown
        rows = np.concatenate([at.pos, at.quat], axis=1).round(4).tolist()
        return dict(zip((prop.name for prop in scene.bodied), rows, strict=True))

    def replay(self) -> Replay | None:
        """The take being shown."""
        replay = self.runtime.replay
        if self.runtime.mode != "replay" or replay is None:
            return None
        return Replay(
            name=replay.name,
            t=round(replay.place, 3),
            seconds=round(replay.length, 3),
            playing=replay.playing,
            speed=replay.speed,
            loop=replay.loop,
            aligned=replay.aligned,
        )


class Key(NamedTuple):
    """kind: its type, for the schema. of: reads it off what is `Seen`."""

    kind: Any
    of: Callable[[Seen], Any]


LATCHES = {"stopped": bool, "stops": int, "needs_reset": bool, "armed": bool}
"""Of `Safety`; stops: how many there were."""
OF_TICK = ("t", "state", "transition_to", "expert", "votes", "fallen", "why", "counters")


def _of_safety(name: str, kind: type) -> Key:
    return Key(kind, lambda seen: getattr(seen.runtime.safety, name))


def _of_tick(name: str) -> Key:
    return Key(TickMessage.__annotations__[name], lambda seen: seen.tick_message[name])


KEYS: dict[str, Key] = {
    "mode": Key(Mode, lambda seen: seen.runtime.mode),
    **{name: _of_safety(name, kind) for name, kind in LATCHES.items()},
    "reason": Key(Reason, lambda seen: seen.runtime.reason),
    **{name: _of_tick(name) for name in OF_TICK},
    "state_lock": Key(
        Annotated[str, OneOf("state", ("auto", *STATES))],
        lambda seen: seen.runtime.puppeteer.lock or "auto",
    ),
    "stale_s": Key(float | None, Seen.stale_s),
    "source": Key(str, lambda seen: seen.runtime.source.name),
    "source_report": Key(SourceReport, Seen.source_report),
    "arrivals": Key(Arrivals | None, Seen.arrivals),
    "scene": Key(str, lambda seen: seen.runtime.puppeteer.stage.name),
    "progress": Key(Progress, lambda seen: seen.runtime.puppeteer.stage.progress()),
    "person": Key(str, lambda seen: seen.runtime.runs.person),
    "props": Key(dict[str, list[float]], Seen.props),
    "push": Key(
        list[float], lambda seen: seen.runtime.puppeteer.stage.push_force.round(2).tolist()
    ),
    "latency_ms": Key(dict[str, float], lambda seen: seen.tick_message["timings_ms"]),
    "period_error_ms": Key(dict[str, float], Seen.punctuality),
    "robot": Key(Pose, lambda seen: part("robot", seen.tick.robot, "trace")),
    "link": Key(RobotBehind | None, Seen.link),
    "controller": Key(Controller, lambda seen: seen.runtime.puppeteer.controller.name),
    "style": Key(Style, lambda seen: seen.runtime.puppeteer.config.style),
    "gains": Key(dict[str, float], lambda seen: asdict(seen.runtime.puppeteer.retargeter.settings)),
    "mirror": Key(bool, lambda seen: seen.runtime.puppeteer.config.mirror),
    "travel": Key(Following, Seen.travel),
    "steps": Key(Steps, lambda seen: seen.runtime.puppeteer.config.steps),
    "calibration": Key(Calibration, Seen.calibration),
    "recording": Key(Recording | None, Seen.recording),
    "recording_error": Key(str | None, lambda seen: seen.runtime.recording_error),
    "replay": Key(Replay | None, Seen.replay),
    "transport": Key(Played | None, lambda seen: transport.as_dict(seen.runtime)),
    "collect": Key(Collect, lambda seen: seen.runtime.collector.as_dict()),
    "mapper": Key(MapperInUse, lambda seen: seen.runtime.mappers.as_dict()),
}
"""What the state says: docs/contract.md's keys, and what a page shows besides."""


def latches(safety: "Safety") -> dict[str, Any]:
    """Those of KEYS that a stop changes at once."""
    told = {name: getattr(safety, name) for name in LATCHES}
    return {**told, "reason": safety.reason, "why": safety.stop_line}


def state_dict(
    runtime: "Runtime", tick: Tick, now: float, period_error_ms: deque[float]
) -> dict[str, Any]:
    """The object itself. now: s on the loop's clock."""
    seen = Seen(runtime=runtime, tick=tick, now=now, period_error_ms=period_error_ms)
    return {name: key.of(seen) for name, key in KEYS.items()}
