"""`evaluate all`: every table, one after the other, in as many goes as it takes.

A table is skipped where it is kept already, made by this code and these models with these options.
One that fails is a row that says why, and the others go on.
"""

import json
import logging
import time
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from studio.control.policy import MODELS
from studio.errors import StudioError
from studio.evaluation.options import AllOptions as Options
from studio.evaluation.options import TableOptions
from studio.evaluation.registry import KEPT, TABLES, run_table, table
from studio.files import STUDIO, fingerprint, write_whole
from studio.training.machine import commit, machine

log = logging.getLogger(__name__)
MADE = "made"
"""Folder beside the kept tables: how each was made, which its rows do not say."""
SMOKE_KEPT = Path("runs/evaluate/smoke")
APART = ("web", "cli", "bench", "client", "__main__.py", "__init__.py")
"""Of studio/, what no table is made by."""
ONE, FEW = {"episodes": 1}, {"episodes": 4}
DRIVES = {"episodes": 1, "seconds": 4.0}
SMOKE: dict[str, dict[str, Any]] = {
    **dict.fromkeys(("tracking", "transitions", "kicks", "ablation", "curriculum", "future"), FEW),
    **dict.fromkeys(("endurance", "faults", "link", "sim2sim"), DRIVES),
    **dict.fromkeys(("tilt", "walk", "reach"), ONE),
    **dict.fromkeys(("styles", "travel", "response", "hands"), ONE),
    "workspace": {"episodes": 2},
    "figures": {"episodes": 1, "tasks": ("tilt",), "seconds": 1.0},
    "composite": {"episodes": 1, "scenes": ("greeting",), "controllers": ("policy",)},
    "pairs": {"episodes": 1, "train_seconds": 20.0, "steps": 20, "sizes": (100,)},
    "baselines": {
        "episodes": 1, "train_seconds": 60.0, "steps": 20, "people": 0, "needed": False,
    },
}  # fmt: skip
"""The least of each table that still runs all of it; those that are not here need what a machine
may not have (a browser, clips)."""


def run_all(options: Options, *, keep: Path | None = KEPT) -> dict[str, Any]:
    """Every table that has what it needs, such as clips; each row names its `table`.

    `_failed` says which tables failed; their rows, `failed`, say why.
    """
    rows: list[dict[str, Any]] = []
    failed: list[str] = []
    keep = SMOKE_KEPT if options.smoke and keep == KEPT else keep
    chosen = list(_chosen(options))
    for number, (name, own) in enumerate(chosen, start=1):
        about = {"options": _plain(own), "made_by": _code()}
        found = None if options.fresh else _kept(keep, name, about)
        place = f"{number} of {len(chosen)}, {name}"
        if found is not None:
            log.info("%s: kept", place)
            rows += [{"table": name, **row} for row in found]
            continue
        log.info("%s: begun", place)
        began = time.monotonic()
        try:
            made = run_table(name, own, keep=keep)["rows"]
        except Exception as error:
            why = str(error) or type(error).__name__
            log.error("%s: %s", place, why, exc_info=not isinstance(error, StudioError))
            failed.append(name)
            rows.append(_row_of_failed(name, own, why))
            continue
        seconds = round(time.monotonic() - began, 1)
        log.info("%s: made in %.0f s", place, seconds)
        rows += [{"table": name, **row} for row in made]
        if keep is not None:
            facts = {**about, "seconds": seconds, "commit": commit(), **machine()}
            write_whole(_facts(keep, name), json.dumps(facts, indent=1), parents=True)
    out: dict[str, Any] = {"rows": rows}
    if failed:
        out["_failed"] = f"not made: {', '.join(failed)} (the row of each says why)"
    return out


def _chosen(options: Options) -> Iterator[tuple[str, TableOptions]]:
    """The tables to be made, each with its own options."""
    given = {key: value for key, value in vars(options).items() if value is not None}
    for name in TABLES:
        each = table(name)
        if not given.keys() >= {*each.needs} or (options.smoke and name not in SMOKE):
            continue
        if options.smoke and name == "sim2sim" and find_spec("pybullet") is None:
            continue
        size = SMOKE[name] if options.smoke else {}
        yield name, each.options(**{key: given[key] for key in each.takes if key in given} | size)


def made_how(tables: Path, name: str) -> dict[str, Any]:
    """How a kept table was made: options, seconds, commit, cpu, cores; {} where nobody knows."""
    try:
        return json.loads(_facts(tables, name).read_text())
    except (OSError, ValueError):
        return {}


def _kept(tables: Path | None, name: str, about: dict[str, Any]) -> list[dict[str, Any]] | None:
    if tables is None or not about.items() <= made_how(tables, name).items():
        return None
    try:
        return json.loads((tables / f"{name}.json").read_text())
    except (OSError, ValueError):
        return None


def _facts(tables: Path, name: str) -> Path:
    return tables / MADE / f"{name}.json"


def _code() -> str:
    parts = [path for path in sorted(STUDIO.iterdir()) if path.name not in APART]
    code = [
        path.name.removesuffix(".py") for path in parts if path.is_dir() or path.suffix == ".py"
    ]
    models = MODELS.parent
    weights = sorted(models.rglob("*.safetensors")) + sorted(models.rglob("*.json"))
    return fingerprint(*code, *weights)


def _plain(options: TableOptions) -> Any:
    return json.loads(json.dumps(vars(options), default=str, sort_keys=True))


def _row_of_failed(name: str, options: TableOptions, why: str) -> dict[str, Any]:
    return {
        "table": name,
        "case": name,
        "controller": "",
        "seed": options.seed,
        "episodes": 0,
        "commit": commit(),
        "failed": why,
    }
