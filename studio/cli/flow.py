"""`serve`, `drive`, `robot`, `bench`: the flow with a page or without, a robot, what it costs."""

from collections.abc import Sequence
from dataclasses import dataclass

import tyro

from studio.cli.output import Answer
from studio.options import BenchConfig, DriveConfig, RobotConfig, ServeConfig


def _with_sources(options: type, *, served: bool = True) -> str:
    """What a command does, and the sources that it knows."""
    from studio.sources import listed

    return f"{options.__doc__}\n\nSources: {listed(served=served)}."


def serve(argv: Sequence[str]) -> None:
    config = tyro.cli(
        ServeConfig, prog="a1-studio serve", description=_with_sources(ServeConfig), args=argv
    )
    from studio.web.serve import serve as run_server

    run_server(config)


def drive(argv: Sequence[str]) -> Answer:
    says = _with_sources(DriveConfig, served=False)
    config = tyro.cli(DriveConfig, prog="a1-studio drive", description=says, args=argv)
    from studio.evaluation.drive import run_drive

    return run_drive(config)


def robot(argv: Sequence[str]) -> None:
    config = tyro.cli(RobotConfig, prog="a1-studio robot", args=argv)
    from studio.link.process import run_robot

    run_robot(config)


def bench(argv: Sequence[str]) -> Answer:
    config = tyro.cli(BenchConfig, prog="a1-studio bench", args=argv)
    from studio.bench.run import run_bench

    return run_bench(config)


@dataclass(frozen=True, kw_only=True)
class OpenApi:
    """Print the API's schema (OpenAPI 3.1), without starting a server."""


def openapi(argv: Sequence[str]) -> Answer:
    tyro.cli(OpenApi, prog="a1-studio openapi", args=argv)
    from studio.web.gateway import openapi as schema

    return schema()
