"""What mappers make of synthetic people, as motions to train on."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from studio.reference.sitting import TILT_LIMIT
from studio.rl.bank import MotionBank, build_bank
from studio.training import retargeted
from studio.training.retargeted import ACTED, TASK, acted_bank, with_people


@pytest.mark.slow
def test_a_person_who_marches_before_a_robot_that_sits_makes_it_twitch(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setitem(retargeted.ACTED, "sit", replace(ACTED["sit"], sources=("operator:march",)))
    bank = acted_bank("sit", 1, seed=0, frames=121)
    assert bank.state == "sit"
    assert bank.leg_contact
    assert bank.tasks == (TASK,)
    assert len(bank) >= 4  # 26 s in pieces of 4
    tilt = bank.feature[..., 13:15]
    assert np.abs(tilt).max() < TILT_LIMIT[:2].max() + 1e-6
    rate = np.abs(np.diff(tilt[..., 0], axis=1)) * 30.0
    library = build_bank("sit", per_task=2, seconds=4.0, difficulties=(1.0,))
    usual = np.abs(np.diff(library.feature[..., 13], axis=1)) * 30.0
    assert rate.max() > 1.5 * usual.max()  # no library motion is so quick


def test_a_state_without_acted_tasks_or_people_keeps_its_bank() -> None:
    bank = build_bank("stand", per_task=1, seconds=2.0, difficulties=(1.0,))
    assert with_people(bank, 3, 0) is bank
    assert with_people(replace(bank, state="sit"), 0, 0).tasks == bank.tasks


def test_people_are_acted_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    bank = build_bank("sit", per_task=1, seconds=2.0, difficulties=(1.0,))
    acted: list[tuple] = []

    def act(*drawn: object) -> MotionBank:
        acted.append(drawn)
        return replace(bank, tasks=(TASK,), task=0 * bank.task)

    monkeypatch.setattr(retargeted, "acted_bank", act)
    for people in (2, 2, 3):
        both = with_people(bank, people, 0, tmp_path)
        assert both.tasks == (*bank.tasks, TASK)
        assert len(both) == 2 * len(bank)
    assert [people for _, people, *_ in acted] == [2, 3]
