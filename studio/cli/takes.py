"""`takes WHAT [NAME …]`: the functions of takes.commands, their parameters as options."""

import inspect
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import tyro

from studio.cli.output import Answer, take_option, usage


def takes(argv: Sequence[str]) -> Answer:
    from studio.mocap.imports import import_take
    from studio.takes import commands

    known = {
        name.removesuffix("s").removesuffix("_take"): function
        for name, function in vars(commands).items()
        if name.endswith(("_take", "_takes")) and callable(function)
    } | {"import": import_take}
    argv, sessions = take_option(list(argv), "--sessions")
    if not argv or argv[0] not in known:
        text = f"usage: a1-studio takes {'|'.join(known)} [NAME] [OPTIONS] [--sessions DIR]"
        usage(text, 0 if argv[:1] in (["-h"], ["--help"]) else 2)
    what, rest = argv[0], argv[1:]
    if what in ("verify", "export") and rest and not rest[0].startswith("-"):
        rest = ["--name", *rest]  # a name that may be left out
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


def _in_order(function: Callable[..., Any]) -> str:
    """What a function says of itself, and the arguments that it needs, in their order."""
    needed = [
        name.upper()
        for name, parameter in inspect.signature(function).parameters.items()
        if parameter.default is inspect.Parameter.empty and name != "sessions"
    ]
    return f"{inspect.getdoc(function)}" + (f" Arguments: {' '.join(needed)}." if needed else "")
