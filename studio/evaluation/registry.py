"""The tables by name: `evaluate NAME` is `run_NAME(Options)` of the file of that name here."""

import json
from collections.abc import Callable
from dataclasses import dataclass, fields
from importlib import import_module
from pathlib import Path
from typing import Any

from studio.errors import unknown_name
from studio.evaluation.options import TableOptions
from studio.files import write_whole

KEPT = Path("runs/evaluate/tables")
"""Where each table is kept as last made, for `a1-studio report`."""
TABLES = {
    "tracking": "how well references are tracked under Table I",
    "transitions": "into each state from the others",
    "tilt": "how far the trunk tilts, of what was asked",
    "walk": "speeds and turns, of what was asked",
    "reach": "how high a paw comes",
    "kicks": "who survives a kick",
    "workspace": "the volume that a paw reaches, with tilts and without",
    "ablation": "what each part of the recipe is worth",
    "curriculum": "what the curriculum is worth",
    "future": "what knowing the future is worth",
    "endurance": "minutes of driving: mean time between falls",
    "faults": "a line that drops, delays, swaps, doubles or spoils human frames",
    "link": "what a robot link bears: delay, jitter and loss, for targets and references",
    "sim2sim": "exported policies in a second engine (with a1-studio[pybullet])",
    "styles": "three ways of meaning walk, in physics",
    "travel": "who crosses the room: speeds and turns, of what the person did",
    "composite": "who completes the scenes, step by step",
    "response": "how late the robot does what a person does, stage by stage",
    "latency": "how late a camera's frame is, section by section, in a browser (needs chromium)",
    "hands": "how high a paw comes by how high the wrist is",
    "figures": "strips of person, reference and robot for each task, as pictures",
    "pairs": "the mapper beside simpler ones, by number of pairs",
    "baselines": "the mapper beside the paper's rivals: errors, time, pairs, what the policy makes",
    "people": "real clips that nothing was trained on (needs --clips)",
    "operator_statistics": "the synthetic operator's ranges beside real ones (needs --clips)",
}
"""Name: what it tells. A table that is not here is not built."""


@dataclass(frozen=True)
class Table:
    """options: the dataclass of what it takes. run: from that to `{"rows": [...]}`."""

    name: str
    options: type[TableOptions]
    run: Callable[[Any], dict[str, Any]]

    @property
    def takes(self) -> list[str]:
        """The names of its options."""
        return [field.name for field in fields(self.options)]

    @property
    def needs(self) -> list[str]:
        """The names of those without a default."""
        return [f.name for f in fields(self.options) if f.default is f.default_factory]


def table(name: str) -> Table:
    """One table, its file loaded. StudioError, naming those that there are, for an unknown one."""
    if name not in (*TABLES, "all"):
        raise unknown_name("evaluation", name, (*TABLES, "all"))
    module = import_module(f"studio.evaluation.{name}")
    return Table(name, module.Options, getattr(module, f"run_{name}"))


def run_table(name: str, options: TableOptions, *, keep: Path | None = KEPT) -> dict[str, Any]:
    """`{"rows": [...]}` of one table, or of all; each is kept in `keep` as it is made."""
    if name == "all":
        return import_module("studio.evaluation.all").run_all(options, keep=keep)
    made = table(name).run(options)
    if keep is not None:
        rows = json.dumps(made["rows"], default=float)
        write_whole(keep / f"{name}.json", rows, parents=True)
        (keep / "made" / f"{name}.json").unlink(missing_ok=True)  # of the one before
    return made
