"""The whole flow without a browser: a source driven to its end → the report of docs/contract.md."""

import contextlib
import json
from collections.abc import Callable
from pathlib import Path
from typing import IO, Any

from studio.control.drive_command import PuppeteerConfig
from studio.errors import StudioError
from studio.evaluation.behind import drive, met, stood_up
from studio.evaluation.drive_report import DriveReport, trace_line
from studio.link.udp import open_link
from studio.live.mappers import is_rival
from studio.live.mappers import open_mapper as open_trained
from studio.mocap.joint_maps import read_joint_map
from studio.options import DriveConfig
from studio.retarget.settings import joint_speed
from studio.retarget.store import Experts
from studio.sources import Source, open_source, usages
from studio.takes.record.recorder import Recorder
from studio.takes.tick import Tick
from studio.training.rivals import OURS, SHIPPED, open_mapper

TOUR_SECONDS = 40.0
"""How long an endless operator is followed if nothing else is said: one tour of every task."""


def run_drive(
    config: DriveConfig,
    *,
    on_tick: Callable[[Tick], None] | None = None,
    source: Source | None = None,
) -> dict[str, Any]:
    """Drive and report. Ends with the source, after config.seconds, or when the robot falls.

    on_tick: called with every tick. source: used instead of opening that of
    config. A `_failed` in the report is the line to fail with: the source had frames, and all were
    refused. Raises StudioError for a source, state, style, controller or scene that is not there,
    and for a robot that does not answer, does not stand up, or stops itself.
    """
    source = source or open_source(
        config.source,
        seed=config.seed,
        style=config.style,
        sessions=config.sessions,
        joint_map=read_joint_map(config.joint_map) if config.joint_map is not None else None,
    )
    with contextlib.ExitStack() as stack:
        stack.callback(source.close)
        seconds = _how_long(config, source)
        puppeteer = met(
            source,
            PuppeteerConfig(
                style=config.style,
                controller=config.controller,
                state=config.state,
                seed=config.seed,
                scene=config.scene,
                mirror=config.mirror,
                travel=config.travel,
                steps=config.steps,
                joint_speed=joint_speed(config.max_joint_speed),
            ),
            link := open_link(config.robot, config.robot_level, config.robot_secret),
        )
        stack.callback(puppeteer.link.close)
        if config.mapper not in (OURS, SHIPPED):
            puppeteer.set_experts(_mapper(config))
        stood_up(puppeteer)
        report = DriveReport()
        sinks: list[Callable[[Tick], None]] = [report.add]
        if on_tick is not None:
            sinks.append(on_tick)
        if config.trace is not None:
            sinks.append(_tracer(stack.enter_context(_opened(config.trace))))
        if config.record:
            recorder = Recorder(config.sessions)
            stack.callback(recorder.close)
            about = {"source": config.source, "seed": config.seed}
            about |= {"style": config.style, "scene": config.scene, "mapper": config.mapper}
            taken = recorder.start("drive", about=about)
            sinks.append(recorder.append)
        paced = config.realtime or link is not None  # any other robot has a clock of its own
        for tick in drive(puppeteer, source, seconds, realtime=paced):
            for sink in sinks:
                sink(tick)
        expected = seconds if source.duration is None else min(seconds, source.duration)
        out = report.summary(expected, rejected_by_source=source.rejected)
        found = source.report.and_refused(puppeteer.person.refused)
        out["source_report"] = found.as_dict()
        out["progress"] = puppeteer.stage.progress()
        if out["frames"] == 0 and found.refused.frames:
            why = f"all {found.refused.frames} frames were refused, {found.refused.why[0]}"
            out["_failed"] = f"{config.source}: {why}"
        if config.record:
            out["take"] = taken
        return out


def _mapper(config: DriveConfig) -> Experts:
    """StudioError where there is none, it refuses a state, or it walks in another style."""
    name, style = config.mapper, config.style
    if ":" in name or is_rival(config.sessions, name):
        return open_mapper(name, style, config.state)
    experts = open_trained(config.sessions, name, style).experts
    if experts.style != style:
        raise StudioError(f"mapper {name} walks by {experts.style}: say --style {experts.style}")
    return experts


def _how_long(config: DriveConfig, source: Source) -> float:
    if not source.starts_live:
        raise StudioError(
            f"source {config.source!r} has frames only while `a1-studio serve` runs: "
            f"drive one of {', '.join(usages(served=False))}"
        )
    if config.seconds is not None:
        if not 0.0 < config.seconds <= 86_400.0:
            raise StudioError(f"--seconds must be over 0 and at most 86400, not {config.seconds}")
        return config.seconds
    return TOUR_SECONDS if source.duration is None else source.duration + 1.0


def _opened(path: Path) -> IO[str]:
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        return path.open("w", encoding="utf-8")
    except OSError as error:
        raise StudioError(f"cannot write {path}: {error.strerror}") from error


def _tracer(file: IO[str]) -> Callable[[Tick], None]:
    def write(tick: Tick) -> None:
        file.write(json.dumps(trace_line(tick)) + "\n")

    return write
