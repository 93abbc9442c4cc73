"""One pose in plain floats must be what the batch says of it."""

import numpy as np
import pytest

from studio.robot import a1, kinematics

RNG = np.random.default_rng(3)
JOINTS = RNG.uniform(a1.JOINT_LOWER, a1.JOINT_UPPER, (500, 12))
REACHED = kinematics.foot_pos_b(JOINTS)
ANYWHERE = RNG.normal(0.0, 0.4, (500, 4, 3))


def test_feet_of_one_pose_are_the_batch_row() -> None:
    one_by_one = np.array([kinematics.foot_pos_b(q) for q in JOINTS])
    np.testing.assert_allclose(one_by_one, REACHED, atol=1e-14)


@pytest.mark.parametrize("feet", [REACHED, ANYWHERE], ids=["within reach", "anywhere"])
@pytest.mark.parametrize("near", [None, JOINTS], ids=["nearest to zero", "nearest to a pose"])
def test_legs_of_one_pose_are_the_batch_row(feet: np.ndarray, near: np.ndarray | None) -> None:
    joints, error = kinematics.leg_ik(feet, near)
    for i in range(len(feet)):
        one, one_error = kinematics.leg_ik(feet[i], None if near is None else near[i])
        np.testing.assert_allclose(one, joints[i], atol=1e-12)
        np.testing.assert_allclose(one_error, error[i], atol=1e-12)


def test_a_batch_of_one_keeps_its_shape() -> None:
    joints, error = kinematics.leg_ik(REACHED[:1], JOINTS[:1])
    assert kinematics.foot_pos_b(JOINTS[:1]).shape == (1, 4, 3)
    assert joints.shape == (1, 12)
    assert error.shape == (1, 4)
