"""`serve`, `drive` and `bench`: the flow in a browser, without one, and what it costs."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import tyro

from studio.cli.output import Answer
from studio.options import ControllerName, ServeConfig, StateOption, Style, Travel


@dataclass(frozen=True, kw_only=True)
class Drive:
    """Run the whole flow without a browser, as fast as it goes, and report on it."""

    source: str
    """operator[:TASK], bvh:FILE, frames:FILE or take:NAME."""
    seconds: float | None = None
    """When to end at the latest (an endless operator: 40 s, a tour of every task)."""
    seed: int = 0
    """Of the synthetic operator and the world."""
    state: StateOption = "auto"
    """Stay in one state, or let the selector decide."""
    style: Style = "march"
    """Which human motion means walking."""
    controller: ControllerName | None = None
    """What turns the reference into an action (default: policy once trained)."""
    scene: Literal["empty"] = "empty"
    """What stands around the robot."""
    mirror: bool = False
    """Mirror the person."""
    travel: Travel = "auto"
    """Walk through space beside a person who does (auto), or read marches alone (off)."""
    sessions: Path = Path("sessions")
    """Folder of recorded takes."""
    record: bool = False
    """Keep the drive as a take."""
    trace: Path | None = None
    """Write a JSON line per tick to this file."""
    realtime: bool = False
    """Pace it at 30 Hz."""
    joint_map: Path | None = None
    """JSON that says which joint of a BVH is which, {"l_hip": "NAME", …}: remembered for others
    with the same joint names."""


@dataclass(frozen=True, kw_only=True)
class Bench:
    """Measure the control period, the drive and the page on this machine."""

    compare: Path | None = None
    """An earlier --json to compare with."""
    seconds: float = 20.0
    """How long each part is measured."""
    page: bool = True
    """Also start a server, connect four clients and measure the loop's periods."""
    browser: bool = True
    """Also measure them beside a Chromium that draws the page (needs one)."""
    training: bool = True
    """Also measure physics, environment and PPO as environments grow."""
    takes: bool = True
    """Also measure what takes cost as there are more of them and longer ones."""


def serve(argv: Sequence[str]) -> None:
    config = tyro.cli(ServeConfig, prog="a1-studio serve", args=argv)
    from studio.web.serve import serve as run_server

    run_server(config)


def drive(argv: Sequence[str]) -> Answer:
    args = tyro.cli(Drive, prog="a1-studio drive", args=argv)
    from studio.control.staleness import stale_command
    from studio.evaluation.drive import DriveConfig, run_drive

    settings = {name: value for name, value in vars(args).items() if name != "scene"}
    return run_drive(DriveConfig(**settings), guard=stale_command)


def bench(argv: Sequence[str]) -> Answer:
    args = tyro.cli(Bench, prog="a1-studio bench", args=argv)
    from studio.bench.run import BenchConfig, run_bench

    return run_bench(BenchConfig(**vars(args)))


@dataclass(frozen=True, kw_only=True)
class OpenApi:
    """Print the API's schema (OpenAPI 3.1), without starting a server."""


def openapi(argv: Sequence[str]) -> Answer:
    tyro.cli(OpenApi, prog="a1-studio openapi", args=argv)
    from studio.web.gateway import openapi as schema

    return schema()
