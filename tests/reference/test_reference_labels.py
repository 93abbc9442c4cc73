"""What mappers learn from: the same for a motion wherever it is, mirrors exactly, one way only."""

import numpy as np
import pytest

from studio import geometry
from studio.reference.contact import contact_labels
from studio.reference.labels import DIMS, label_motion, mirror_labels
from studio.reference.library import TASKS
from studio.reference.motion import ReferenceMotion
from studio.reference.realize import realize
from studio.reference.stances import tilt_of
from studio.robot import a1, kinematics

DT = 1.0 / 30.0


def motion_of(task: str, seed: int = 4) -> ReferenceMotion:
    return realize(TASKS[task].sample(np.random.default_rng(seed), 4.0))


def labelled(state: str, motion: ReferenceMotion, start: int = 0) -> dict[str, np.ndarray]:
    parts = (motion.base_pos[start:], motion.base_quat[start:], motion.joint_pos[start:])
    return label_motion(state, *parts, motion.dt)  # type: ignore[arg-type]


def test_labels_of_a_steady_walk_have_its_speed_and_no_heading():
    # 0.3 m/s along a heading of 90 degrees: forward in the state's frame, nothing sideways.
    n = 30
    pos = np.zeros((n, 3))
    pos[:, 1] = 0.3 * DT * np.arange(n)
    quat = np.tile(geometry.quat_from_rpy([0.0, 0.0, np.pi / 2]), (n, 1))
    out = label_motion("walk", pos, quat, np.tile(a1.STAND_JOINT_POS, (n, 1)), DT)
    np.testing.assert_allclose(out["base_lin_vel"][6:], [[0.3, 0.0, 0.0]] * (n - 6), atol=1e-9)
    np.testing.assert_allclose(out["base_quat"], [[1.0, 0.0, 0.0, 0.0]] * n, atol=1e-9)
    np.testing.assert_allclose(out["base_lin_acc"][6:], 0.0, atol=1e-9)
    assert {name: x.shape for name, x in out.items()} == {k: (n, d) for k, d in DIMS.items()}


@pytest.mark.parametrize(("task", "state"), [("tilt", "stand"), ("sit_tilt", "sit")])
def test_a_motion_cut_in_the_middle_of_a_twist_keeps_its_labels(task, state):
    motions = [motion_of(task, seed) for seed in range(6)]
    twists = [np.abs(tilt_of(state, motion.base_quat)[:, 2]) for motion in motions]
    k = int(np.argmax([twist[:-30].max() for twist in twists]))
    motion, start = motions[k], int(np.argmax(twists[k][:-30]))
    assert np.degrees(twists[k][start]) > 0.3
    whole = labelled(state, motion)
    cut = labelled(state, motion, start)
    np.testing.assert_allclose(cut["base_quat"], whole["base_quat"][start:], atol=1e-6)
    np.testing.assert_allclose(
        cut["base_lin_vel"][3:], whole["base_lin_vel"][start + 3 :], atol=1e-6
    )


def test_contacts_are_those_of_the_motion_that_is_labelled():
    motion = motion_of("walk")
    feet = kinematics.foot_pos_w(motion.base_pos, motion.base_quat, motion.joint_pos)
    out = labelled("walk", motion)["contact"]
    np.testing.assert_array_equal(out, contact_labels(feet, motion.dt))
    np.testing.assert_allclose(out, motion.foot_contact, atol=1e-9)  # as the library says itself


@pytest.mark.parametrize(
    ("task", "state"), [("turn", "walk"), ("manipulate_left", "stand"), ("sit_tilt", "sit")]
)
def test_labels_of_the_mirrored_motion_are_the_mirrored_labels(task, state):
    motion = motion_of(task)
    mirrored = label_motion(
        state,
        motion.base_pos * [1.0, -1.0, 1.0],
        -motion.base_quat * [1.0, -1.0, 1.0, -1.0],  # the same rotation, w < 0
        motion.joint_pos[:, a1.MIRROR_JOINT] * a1.MIRROR_SIGN,
        motion.dt,
    )
    expected = mirror_labels(labelled(state, motion))
    assert mirrored["base_quat"][:, 0].min() > 0.0
    for name in DIMS:
        np.testing.assert_allclose(mirrored[name], expected[name], atol=1e-7, err_msg=name)
