"""The commands of contract.md: arguments in, one object or one line out; nothing is computed here.

Rooms are imported by the command that needs them, so that `--help` answers at once.
"""

import inspect
import json
import logging
import math
import os
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, Literal

os.environ.setdefault("OMP_NUM_THREADS", "1")  # one BLAS thread in the loop (findings.md)

import tyro

from studio import __version__
from studio.errors import StudioError, unknown_name
from studio.options import ControllerName, ServeConfig, StateOption, Style

Answer = dict[str, Any]


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
    sessions: Path = Path("sessions")
    """Folder of recorded takes."""
    record: bool = False
    """Keep the drive as a take."""
    trace: Path | None = None
    """Write a JSON line per tick to this file."""
    realtime: bool = False
    """Pace it at 30 Hz."""


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


@dataclass(frozen=True, kw_only=True)
class OpenApi:
    """Print the API's schema (OpenAPI 3.1), without starting a server."""


@dataclass(frozen=True, kw_only=True)
class Evaluate:
    """Make one of the tables: `a1-studio evaluate NAME`."""

    name: tyro.conf.Positional[str]
    """Which table; an unknown name lists those that can be made."""
    episodes: int | None = None
    """Episodes a row (default: the table's own)."""
    seed: int = 0
    """Everything drawn follows from it."""
    clips: Path | None = None
    """Folder of real motion clips (people)."""
    style: Style | None = None
    """Which human motion means walking (default: the table's own)."""
    controller: ControllerName | None = None
    """What turns the reference into an action (default: the table's own)."""
    threads: int | None = None
    """Cores to use (default: the table's own)."""


# One function a command: argv (without the command's name) -> the object for --json, or None.


def _serve(argv: Sequence[str]) -> None:
    config = tyro.cli(ServeConfig, prog="a1-studio serve", args=argv)
    from studio.web.serve import serve

    serve(config)


def _drive(argv: Sequence[str]) -> Answer:
    args = tyro.cli(Drive, prog="a1-studio drive", args=argv)
    from studio.evaluation.drive import DriveConfig, run_drive
    from studio.live.safety import stale_orders

    settings = {name: value for name, value in vars(args).items() if name != "scene"}
    return run_drive(DriveConfig(**settings), guard=stale_orders)


def _bench(argv: Sequence[str]) -> Answer:
    args = tyro.cli(Bench, prog="a1-studio bench", args=argv)
    from studio.bench.run import BenchConfig, run_bench

    return run_bench(BenchConfig(**vars(args)))


def _evaluate(argv: Sequence[str]) -> Answer:
    args = tyro.cli(Evaluate, prog="a1-studio evaluate", args=argv)
    from studio.evaluation.registry import available, run_evaluation

    known = (*available(), "all")
    if args.name not in known:
        _usage(str(unknown_name("evaluation", args.name, known)), 2)
    return run_evaluation(**vars(args))


def _train(argv: Sequence[str]) -> Answer:
    kinds = {"mapper": _train_mapper, "policy": _train_policy}
    if not argv or argv[0] not in kinds:
        _usage(f"a1-studio train {'|'.join(kinds)} [--help]", 0 if "--help" in argv else 2)
    return kinds[argv[0]](argv[1:])


def _train_mapper(argv: Sequence[str]) -> Answer:
    if any(arg.partition("=")[0] in ("--takes", "--dataset") for arg in argv):
        from studio.training.collected import TakesTraining, run_train_takes

        return run_train_takes(tyro.cli(TakesTraining, prog="a1-studio train mapper", args=argv))
    from studio.training.mapper import run_train_mapper
    from studio.training.mapper_fit import MapperTraining

    return run_train_mapper(tyro.cli(MapperTraining, prog="a1-studio train mapper", args=argv))


def _train_policy(argv: Sequence[str]) -> Answer:
    from studio.training.policy import run_train_policy
    from studio.training.policy_settings import PolicyTraining

    logging.getLogger("studio.training.policy").setLevel(logging.INFO)  # its progress
    return run_train_policy(tyro.cli(PolicyTraining, prog="a1-studio train policy", args=argv))


def _takes(argv: Sequence[str]) -> Answer:
    """`takes WHAT [NAME …]`: the functions of recording.commands, their parameters as options."""
    from studio.mocap.imports import import_take
    from studio.takes import commands

    known = {
        name.removesuffix("s").removesuffix("_take"): function
        for name, function in vars(commands).items()
        if name.endswith(("_take", "_takes")) and callable(function)
    } | {"import": import_take}
    argv, sessions = _take_option(list(argv), "--sessions")
    if not argv or argv[0] not in known:
        text = f"usage: a1-studio takes {'|'.join(known)} [NAME] [OPTIONS] [--sessions DIR]"
        _usage(text, 0 if argv[:1] in (["-h"], ["--help"]) else 2)
    what, rest = argv[0], argv[1:]
    if what == "verify" and rest and not rest[0].startswith("-"):
        rest = ["--name", *rest]
    answer: Answer = tyro.cli(  # type: ignore[assignment]
        partial(known[what], Path(sessions or "sessions")),
        prog=f"a1-studio takes {what}",
        description=_in_order(known[what]),
        args=rest,
        config=(tyro.conf.PositionalRequiredArgs,),
    )
    verified = answer.get("takes", ()) if what == "verify" else ()
    lost = [take["name"] for take in verified if not take["readable"]]
    if lost:
        return {**answer, "_failed": f"cannot be read: {', '.join(lost)}"}
    if why := answer.get("refused"):
        each = "; ".join(f"{name}: {reason}" for name, reason in why.items())
        return {**answer, "_failed": f"not imported: {each}"}
    return answer


def _openapi(argv: Sequence[str]) -> Answer:
    tyro.cli(OpenApi, prog="a1-studio openapi", args=argv)
    from studio.web.schema import openapi

    return openapi()


def _in_order(function: Callable[..., Any]) -> str:
    """What a function says of itself, and the arguments that it needs, in their order."""
    needed = [
        name.upper()
        for name, parameter in inspect.signature(function).parameters.items()
        if parameter.default is inspect.Parameter.empty and name != "sessions"
    ]
    return f"{inspect.getdoc(function)}" + (f" Arguments: {' '.join(needed)}." if needed else "")


COMMANDS: dict[str, tuple[Callable[[Sequence[str]], Any], str]] = {
    "serve": (_serve, "open the studio in a browser"),
    "drive": (_drive, "run the whole flow without a browser and report on it"),
    "takes": (_takes, "list, show, trim, label, align, verify, export, import, delete takes"),
    "train": (_train, "train a mapper or a policy"),
    "evaluate": (_evaluate, "make one of the tables or figures"),
    "openapi": (_openapi, "print the API's schema, without starting a server"),
    "bench": (_bench, "measure this machine's figures"),
}


def main(argv: Sequence[str] | None = None) -> None:
    """Run one command; exits with 0 done, 1 failed (one line says why), 2 bad usage."""
    argv = list(sys.argv[1:] if argv is None else argv)
    logging.basicConfig(
        stream=sys.stderr, level=logging.WARNING, format="%(levelname)s %(name)s: %(message)s"
    )
    if not argv or argv[0] in ("-h", "--help"):
        _usage(_overview(), 0 if argv else 2)
    if argv[0] == "--version":
        print(f"a1-studio {__version__}")
        raise SystemExit(0)
    if argv[0] not in COMMANDS:
        _usage(f"unknown command {argv[0]!r}\n\n{_overview()}", 2)
    argv, destination = _take_option(argv, "--json")
    try:
        answer = COMMANDS[argv[0]][0](argv[1:])
        failed = (answer or {}).pop("_failed", "")
        _give(answer, destination)
        if failed:
            raise StudioError(failed)
    except StudioError as error:
        print(" ".join(str(error).split()), file=sys.stderr)
        raise SystemExit(1) from None
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        raise SystemExit(1) from None
    except KeyboardInterrupt:
        raise SystemExit(130) from None
    raise SystemExit(0)


def _overview() -> str:
    lines = [f"  {name:<10}{about}" for name, (_, about) in COMMANDS.items()]
    return "\n".join(
        [
            "usage: a1-studio COMMAND [OPTIONS]",
            "",
            "Drive a Unitree A1 with your own body.",
            "",
            *lines,
            "",
            "a1-studio COMMAND --help lists a command's options. All but serve also take",
            "--json FILE (- for standard output): one object with the result.",
        ]
    )


def _usage(text: str, status: int) -> None:
    print(text, file=sys.stdout if status == 0 else sys.stderr)
    raise SystemExit(status)


def _take_option(argv: list[str], option: str) -> tuple[list[str], str | None]:
    """The arguments without `option VALUE`, and VALUE: --json works the same everywhere."""
    for i, arg in enumerate(argv):
        if arg == option:
            if i + 1 == len(argv):
                _usage(f"{option} needs a value", 2)
            return argv[:i] + argv[i + 2 :], argv[i + 1]
        if arg.startswith(f"{option}="):
            return argv[:i] + argv[i + 1 :], arg.partition("=")[2]
    return argv, None


def _give(answer: Any, destination: str | None) -> None:
    """The object to its file, or what people read of it to the terminal."""
    if answer is None:
        return
    text = json.dumps(_strict(answer), indent=1, default=float, allow_nan=False)
    if destination == "-" or destination is None:
        print(text)
        return
    try:
        path = Path(destination)
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text + "\n", encoding="utf-8")
    except OSError as error:
        raise StudioError(f"cannot write {destination}: {error.strerror}") from error


def _strict(value: Any) -> Any:
    """The same with null for what JSON has no word for: NaN and the infinities."""
    if hasattr(value, "tolist"):  # numpy
        value = value.tolist()
    if isinstance(value, dict):
        return {key: _strict(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_strict(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


if __name__ == "__main__":
    main()
