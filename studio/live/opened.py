"""What commands need opened, read or drawn first, which takes a while: made by any thread.

`prepared` turns such a command into what the loop's thread can apply at once (`live.applying`).
"""

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from studio.control.command import PuppeteerConfig
from studio.human.calibration import Calibration, calibrate
from studio.live import commands as c
from studio.live.collect import CollectPlan, Slot
from studio.live.collecting import draw_slots
from studio.live.mappers import open_mapper
from studio.live.replay import Replay
from studio.sources import Source, open_source
from studio.synthetic.follower import FollowingOperator
from studio.takes.names import take_folder
from studio.takes.take import read_take

if TYPE_CHECKING:
    from studio.live.playback import Playback
    from studio.live.session import Session


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
    from studio.takes.edit.edited import open_table

    table, edits = open_table(config.sessions, command.name)
    playback = Playback(command.name, table, edits, aligned=command.aligned)
    playback.seek(command.t, command.playing, command.speed, command.loop)
    return OpenedReplay(replay=playback)


def prepared(session: "Session", command: Any) -> Any:
    """`command` as the loop's thread can apply it at once. StudioError says what is not there."""
    config, source = session.config, session.source
    match command:
        case c.SetSource():
            return open_for(config, command.spec)
        case c.ShowTake():
            return open_take(config, command)
        case c.SetPlan(plan=plan):
            return DrawnPlan(plan=plan, slots=draw_slots(plan.items, plan.seed))
        case c.AddToPlan():
            machine = session.collector.machine
            slots = draw_slots(command.items, machine.plan.seed, len(machine.slots))
            return DrawnMore(slots=slots)
        case c.SetMapper() | c.SetStyle():
            return open_mapper(config.sessions, config.puppeteer, session.mappers, command)
        case c.SetMode(mode="collect"):
            return OpenedCollect(operator=follower_for(config, source))
        case c.SetMode(mode="replay"):
            kind, _, name = source.name.partition(":")
            take = name if kind == "take" else session.last_take
            return open_replay(config, take) if take else command
        case _:
            return command
