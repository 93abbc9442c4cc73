"""`--mapper`: rivals and anybody's own mapper in the experts' place, and what is refused."""

from pathlib import Path

import numpy as np
import pytest

from studio.errors import StudioError
from studio.evaluation.drive import run_drive
from studio.options import DriveConfig
from studio.retarget.store import load_experts
from studio.training.rivals import open_mapper

PLUGIN = Path(__file__).parents[2] / "docs" / "mapper_plugin.py"


def test_the_shipped_experts_are_a_mapper_too() -> None:
    shipped = load_experts("march")
    opened = open_mapper("expert", "march")
    assert opened.sidecars == shipped.sidecars
    assert opened.stride_gain == shipped.stride_gain


def test_a_rival_takes_the_places_it_is_fitted_for_and_is_taken_at_its_word() -> None:
    opened = open_mapper("yamane2010", "march", "walk", seconds=30.0)
    assert type(opened.mappers["walk"]).__name__ == "Yamane2010"
    assert type(opened.mappers["stand"]).__name__ == "Mapper"
    assert opened.stride_gain == 1.0


def test_who_refuses_a_state_says_with_which_it_would_work() -> None:
    with pytest.raises(StudioError, match="--state walk"):
        open_mapper("kim2020", "march", seconds=30.0)


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("merlin", "seol2013"),
        ("nowhere.py:Bow", "FILE.py:Class"),
        ("no.such.module:Bow", "module:Class"),
        (f"{PLUGIN}:Nobody", "fit"),
        ("studio.robot.a1:LEGS", "fit"),
    ],
)
def test_a_mapper_that_is_not_there_is_answered_with_what_would_work(name: str, says: str) -> None:
    with pytest.raises(StudioError, match=says):
        open_mapper(name, "march", "stand", seconds=12.0)


def test_a_mapper_that_does_not_do_as_an_expert_does_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "odd.py"
    file.write_text(
        "class Odd:\n"
        "    remembers = False\n"
        "    @classmethod\n"
        "    def fit(cls, state, pairs, seed):\n"
        "        return cls()\n"
        "    def begin(self):\n"
        "        return lambda triplet: triplet\n"
    )
    with pytest.raises(StudioError, match="joint_pos"):
        open_mapper(f"{file}:Odd", "march", "stand", seconds=12.0)


def test_the_example_of_a_mapper_of_ones_own_drives_the_robot_down() -> None:
    config = DriveConfig(
        source="operator:manipulate_right", seconds=6.0, state="stand", mapper=f"{PLUGIN}:Bow"
    )
    height = []
    report = run_drive(config, on_tick=lambda tick: height.append(tick.reference.base_pos[2]))
    assert report["survived"]
    assert np.ptp(height) > 0.01
    with pytest.raises(StudioError, match="--state stand"):
        open_mapper(f"{PLUGIN}:Bow", "march", "walk", seconds=12.0)


def test_a_rival_drives_and_the_report_says_who() -> None:
    config = DriveConfig(source="operator:tilt", seconds=5.0, state="stand", mapper="ridge")
    report = run_drive(config)
    assert report["survived"]
    assert report["frames"] > 100
