"""The tables by name: `evaluate NAME` is `run_NAME` of the file of that name in this room."""

import inspect
from collections.abc import Callable
from importlib import import_module
from importlib.util import find_spec
from typing import Any

from studio.errors import unknown_name

NAMES = (
    "tracking", "ablation", "curriculum", "future", "tilt", "walk", "workspace", "composite",
    "latency", "styles", "people", "pairs", "baselines", "transitions",
    "reach", "kicks", "endurance",
)  # fmt: skip
"""Names that contract.md fixes, then our own; those without a file here are not built yet."""


def available() -> list[str]:
    """The tables that can be made."""
    return [name for name in NAMES if find_spec(f"studio.evaluation.{name}") is not None]


def run_evaluation(name: str, **settings: Any) -> dict[str, Any]:
    """{"rows": […]} of one table, or of "all" that need no files of the user's.

    settings that are None are the table's own; those a table does not know are left out for
    "all" and otherwise a TypeError. StudioError for an unknown name.
    """
    settings = {key: value for key, value in settings.items() if value is not None}
    if name == "all":
        skipped = () if "clips" in settings else ("people",)
        rows = []
        for each in available():
            if each not in skipped:
                rows += [{"table": each, **row} for row in _run(each, settings)["rows"]]
        return {"rows": rows}
    if name not in available():
        raise unknown_name("evaluation", name, (*available(), "all"))
    return _run(name, settings)


def _run(name: str, settings: dict[str, Any]) -> dict[str, Any]:
    run: Callable[..., dict[str, Any]] = getattr(
        import_module(f"studio.evaluation.{name}"), f"run_{name}"
    )
    known = inspect.signature(run).parameters
    return run(**{key: value for key, value in settings.items() if key in known})
