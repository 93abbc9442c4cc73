"""Banks on disk: what comes back is what was drawn, and nothing else ever."""

from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest

from studio.rl import bank_store
from studio.rl.bank import MotionBank, build_bank
from studio.rl.bank_store import kept, library_bank

SETTINGS = {"per_task": 1, "seconds": 1.0, "difficulties": (1.0,)}


def same(one: MotionBank, other: MotionBank) -> bool:
    return all(
        np.array_equal(getattr(one, f.name), getattr(other, f.name)) for f in fields(MotionBank)
    )


@pytest.mark.parametrize(("state", "transitions"), [("sit", 0), ("stand", 1)])
def test_a_kept_bank_comes_back_whole(
    state: str, transitions: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    told = {**SETTINGS, "transitions": transitions}
    drawn = build_bank(state, **told)  # type: ignore[arg-type]
    first = library_bank(tmp_path, state, **told)  # type: ignore[arg-type]
    monkeypatch.setattr(bank_store, "build_bank", None)  # read, not drawn again
    again = library_bank(tmp_path, state, **told)  # type: ignore[arg-type]
    assert same(first, drawn)
    assert same(again, drawn)
    assert (again.state, again.tasks, again.leg_contact) == (state, drawn.tasks, True)
    assert again.seen is None
    assert [f.name.split("-")[1] for f in tmp_path.iterdir()] == [state]


def test_what_a_policy_saw_is_kept_too(tmp_path: Path) -> None:
    bank = build_bank("sit", **SETTINGS)  # type: ignore[arg-type]
    bank = replace(bank, seen=bank.feature + 1.0)
    kept(tmp_path, "seen", 1, lambda: bank)
    assert same(kept(tmp_path, "seen", 1, lambda: pytest.fail("drawn again")), bank)


def test_other_keys_draw_anew_and_no_folder_keeps_nothing(tmp_path: Path) -> None:
    bank = build_bank("sit", **SETTINGS)  # type: ignore[arg-type]
    count = 0

    def draw() -> MotionBank:
        nonlocal count
        count += 1
        return bank

    for folder, key in ((tmp_path, 1), (tmp_path, 2), (tmp_path, 1), (None, 1), (None, 1)):
        kept(folder, "some", [key, "key"], draw)
    assert count == 4
    assert len(list(tmp_path.iterdir())) == 2
