"""Ways between states as motions, banks of them, and one bank for one policy of all states."""

import numpy as np
import pytest

from studio import geometry
from studio.reference.intent import StateName
from studio.rl.bank import MotionBank, build_bank, merged, relevelled
from studio.rl.transitions import SOURCES, rests_on_legs, transition_motion, transition_names
from studio.robot import a1

PAIRS = [(source, goal) for goal, sources in SOURCES.items() for source in sources]


@pytest.mark.parametrize(("source", "goal"), PAIRS)
def test_a_crossing_leads_into_the_goal_within_the_speed_of_its_state(
    source: StateName, goal: StateName
) -> None:
    motion = transition_motion(source, goal, np.random.default_rng(3), 6.0)
    assert len(motion) == 181
    assert (motion.state, motion.task) == (goal, f"from_{source}")
    assert np.all(motion.joint_pos >= a1.JOINT_LOWER - 1e-9)
    assert np.all(motion.joint_pos <= a1.JOINT_UPPER + 1e-9)
    way = slice(0, 25)  # still on the way, whatever the goal allows later: 120 deg/s
    assert np.degrees(np.abs(np.diff(motion.joint_pos[way], axis=0)).max()) * 30.0 <= 120.0
    nose_w = geometry.quat_rotate(motion.base_quat, np.array([1.0, 0.0, 0.0]))
    steep = nose_w[:, 2] > np.sin(np.radians(45.0))
    assert steep[-1] == (goal == "sit")
    assert steep[0] == (source == "sit")


def test_every_state_is_entered_from_somewhere_and_sitting_only_from_standing() -> None:
    assert transition_names("stand") == ("from_walk", "from_sit")
    assert transition_names("sit") == ("from_stand",)
    assert rests_on_legs("stand")
    assert not rests_on_legs("walk")


@pytest.fixture(scope="module")
def banks() -> list[MotionBank]:
    settings = {"per_task": 1, "seconds": 2.0, "difficulties": (1.0,)}
    return [
        build_bank("sit", transitions=1, **settings),  # type: ignore[arg-type]
        build_bank("walk", **settings),  # type: ignore[arg-type]
    ]


def test_crossings_join_a_bank_as_its_last_task(banks: list[MotionBank]) -> None:
    assert banks[0].tasks[-1] == "from_stand"
    assert np.sum(banks[0].task == len(banks[0].tasks) - 1) == 1
    assert banks[0].leg_contact


def test_a_merged_bank_holds_every_motion_under_its_own_task(banks: list[MotionBank]) -> None:
    both = merged(banks)
    assert len(both) == sum(len(bank) for bank in banks)
    assert both.tasks == banks[0].tasks + banks[1].tasks
    assert [both.tasks[k] for k in both.task] == [b.tasks[k] for b in banks for k in b.task]
    np.testing.assert_array_equal(both.joint_pos[: len(banks[0])], banks[0].joint_pos)
    # A sitting trunk is steep as a standing robot sees it, and level as a sitting one does.
    sat = both.feature[: len(banks[0]), -1, 14]
    assert np.all(np.degrees(np.abs(sat)) > 40.0)
    assert np.all(np.degrees(np.abs(banks[0].feature[:, -1, 14])) < 30.0)


def test_relevelling_to_its_own_state_changes_nothing(banks: list[MotionBank]) -> None:
    again = relevelled(banks[0], "sit")
    np.testing.assert_allclose(again.feature, banks[0].feature, atol=1e-12)
    np.testing.assert_allclose(again.feet, banks[0].feet, atol=1e-12)
