"""Banks of motions on disk: drawn once, they are read in a blink."""

import hashlib
import json
from collections.abc import Callable
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studio.files import fingerprint, whole
from studio.reference.intent import StateName
from studio.reference.library import task_names
from studio.rl.bank import MotionBank, build_bank

DRAWN_BY = (
    "geometry", "rhythm", "timing", "reference", "robot", "control", "rl/bank", "rl/transitions",
    "rl/curriculum",
)  # fmt: skip
"""The code that a bank's motions depend on."""


def kept(folder: Path | None, name: str, key: Any, draw: Callable[[], MotionBank]) -> MotionBank:
    """The bank that `draw` made before under this name and key, else a new one, then kept.

    key: all that the motions depend on, as JSON can say it. folder: None keeps nothing.
    """
    if folder is None:
        return draw()
    digest = hashlib.sha256(json.dumps(key).encode()).hexdigest()[:16]
    file = folder / f"{name}-{digest}.npz"
    if file.exists():
        return _read(file)
    bank = draw()
    values = {f.name: getattr(bank, f.name) for f in fields(bank)}
    save_arrays(file, {k: np.asarray(v) for k, v in values.items() if v is not None})
    return bank


def save_arrays(file: Path, arrays: dict[str, NDArray[Any]]) -> None:
    """An .npz of arrays of any shape, whole or not at all, whoever else is writing it."""
    with whole(file, parents=True) as scratch, scratch.open("wb") as out:
        np.savez(out, **arrays)  # pyright: ignore[reportArgumentType]


def library_bank(folder: Path | None, state: StateName, **drawn: Any) -> MotionBank:
    """`build_bank` of a state, kept in a folder; changed arguments or code make new ones."""
    key = [fingerprint(*DRAWN_BY), state, task_names(state), sorted(drawn.items())]
    return kept(folder, f"bank-{state}", key, lambda: build_bank(state, **drawn))


def _read(file: Path) -> MotionBank:
    with np.load(file) as saved:
        arrays: dict[str, Any] = {k: saved[k] for k in saved.files}
    words = {
        "state": str(arrays["state"]),
        "tasks": tuple(map(str, arrays["tasks"])),
        "leg_contact": bool(arrays["leg_contact"]),
    }
    return MotionBank(**(arrays | words))
