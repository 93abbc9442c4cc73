"""The commands of docs/contract.md: arguments in, one object or one line out.

Rooms are imported by the command that needs them, so that `--help` answers at once.
"""

import logging
import os
import sys
from collections.abc import Callable, Sequence
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")  # one BLAS thread in the loop (docs/findings.md)

from studio import __version__
from studio.cli import evaluation, flow, takes, training
from studio.cli.output import give, take_option, usage
from studio.errors import StudioError
from studio.files import FULL

# One function a command: argv (without the command's name) -> the object for --json, or None.
COMMANDS: dict[str, tuple[Callable[[Sequence[str]], Any], str]] = {
    "serve": (flow.serve, "open the studio in a browser"),
    "drive": (flow.drive, "run the whole flow without a browser and report on it"),
    "robot": (flow.robot, "be a simulated robot that others drive by UDP"),
    "takes": (takes.takes, "list, show, trim, label, align, verify, export, import, delete takes"),
    "train": (training.train, "train a mapper or a policy"),
    "evaluate": (evaluation.evaluate, "make one of the tables or figures"),
    "report": (evaluation.report, "one page of the tables that evaluate has made"),
    "publish": (training.publish, "ship a trained policy where it beats its baselines"),
    "export": (training.export, "write a policy as ONNX"),
    "openapi": (flow.openapi, "print the API's schema, without starting a server"),
    "bench": (flow.bench, "measure this machine's figures"),
}


def main(argv: Sequence[str] | None = None) -> None:
    """Run one command; exits with 0 done, 1 failed (one line says why), 2 bad usage."""
    argv = list(sys.argv[1:] if argv is None else argv)
    logging.basicConfig(
        stream=sys.stderr, level=logging.WARNING, format="%(levelname)s %(name)s: %(message)s"
    )
    if not argv or argv[0] in ("-h", "--help"):
        usage(_overview(), 0 if argv else 2)
    if argv[0] == "--version":
        print(f"a1-studio {__version__}")
        raise SystemExit(0)
    if argv[0] not in COMMANDS:
        usage(f"unknown command {argv[0]!r}\n\n{_overview()}", 2)
    argv, destination = take_option(argv, "--json")
    try:
        answer = COMMANDS[argv[0]][0](argv[1:])
        failed = (answer or {}).pop("_failed", "")
        give(answer, destination)
        sys.stdout.flush()
        if failed:
            raise StudioError(failed)
    except StudioError as error:
        print(" ".join(str(error).split()), file=sys.stderr)
        raise SystemExit(1) from None
    except BrokenPipeError:
        _drop_stdout()
        raise SystemExit(1) from None
    except OSError as error:
        if error.errno not in FULL:
            raise
        _drop_stdout()
        where = f" {error.filename}" if error.filename else ""
        print(f"cannot write{where}: {error.strerror}; make room", file=sys.stderr)
        raise SystemExit(1) from None
    except KeyboardInterrupt:
        raise SystemExit(130) from None
    raise SystemExit(0)


def _drop_stdout() -> None:
    """What it still holds would fail again when the interpreter ends."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


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
            "a1-studio COMMAND --help lists a command's options. All but serve and robot also take",
            "--json FILE (- for standard output): one object with the result.",
        ]
    )
