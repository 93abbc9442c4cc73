"""The mapper's loss: hand-computed values, and its kinematics against the robot room's."""

import numpy as np
import torch

from studio import geometry
from studio.robot import a1, kinematics
from studio.training.losses import LossWeights, Motion, foot_motion, leg_motion, mapper_loss


def still(n: int = 1, **changes: torch.Tensor) -> Motion:
    """A robot standing still, as a batch of n, with some fields changed."""
    zeros = {f: torch.zeros(n, 3) for f in ("lin_vel", "lin_acc", "ang_vel", "ang_acc")}
    joints = torch.tensor(a1.STAND_JOINT_POS, dtype=torch.float32).repeat(n, 1)
    base: dict[str, torch.Tensor] = {
        "quat": torch.tensor([[1.0, 0.0, 0.0, 0.0]]).repeat(n, 1),
        "joint_pos": joints,
        "joint_vel": torch.zeros(n, 12),
        "joint_acc": torch.zeros(n, 12),
        **zeros,
    }
    return Motion(**{**base, **changes})


def test_a_perfect_prediction_costs_nothing():
    assert float(mapper_loss(still(), still())["total"]) == 0.0


def test_orientation_term_is_one_minus_squared_dot():
    # A turn by 60 degrees about x: q . q_label = cos 30 deg, 1 - cos^2 = 1/4; weighted 0.3 / 4.
    quat = torch.tensor([[np.cos(np.pi / 6), np.sin(np.pi / 6), 0.0, 0.0]], dtype=torch.float32)
    terms = mapper_loss(still(quat=quat), still())
    np.testing.assert_allclose(float(terms["orientation"]), 0.25, atol=1e-6)
    np.testing.assert_allclose(float(terms["total"]), 0.075, atol=1e-6)
    assert abs(float(mapper_loss(still(quat=-still().quat), still())["total"])) < 1e-6


def test_joint_term_sums_squares_over_joints():
    # Two joints off by 0.1 and 0.2 rad: 0.01 + 0.04 = 0.05, weight 1.
    off = still().joint_pos.clone()
    off[0, 1] += 0.1
    off[0, 7] += 0.2
    np.testing.assert_allclose(float(mapper_loss(still(joint_pos=off), still())["joint"]), 0.05)


def test_foot_velocity_term_of_a_moving_base_is_its_speed_on_four_feet():
    # Every foot moves at (0.3, 0.4, 0): 0.25 each, four feet: 1.0, weight 0.001.
    moving = still(lin_vel=torch.tensor([[0.3, 0.4, 0.0]]))
    terms = mapper_loss(moving, still())
    np.testing.assert_allclose(float(terms["foot_vel"]), 1.0, rtol=1e-6)
    np.testing.assert_allclose(float(terms["total"]), 0.001, rtol=1e-6)


def test_leg_motion_agrees_with_the_kinematics_and_its_finite_differences():
    rng = np.random.default_rng(3)
    q = rng.uniform(a1.JOINT_LOWER, a1.JOINT_UPPER, (50, 12))
    dq, ddq = rng.normal(size=(2, 50, 12))
    pos, vel, acc = (x.numpy() for x in leg_motion(*(torch.tensor(x) for x in (q, dq, ddq))))
    np.testing.assert_allclose(pos, kinematics.foot_pos_b(q), atol=1e-6)

    def at(t: float) -> np.ndarray:
        return kinematics.foot_pos_b(q + dq * t + 0.5 * ddq * t * t)

    h = 1e-4
    np.testing.assert_allclose(vel, (at(h) - at(-h)) / (2 * h), atol=1e-6)
    np.testing.assert_allclose(acc, (at(h) - 2 * at(0.0) + at(-h)) / h**2, atol=1e-5)


def test_foot_motion_in_the_world_agrees_with_finite_differences_of_a_tumbling_robot():
    rng = np.random.default_rng(4)
    n, h = 20, 1e-4
    quat = geometry.normalize(rng.normal(size=(n, 4)))
    w, dw, v, a = rng.normal(size=(4, n, 3))
    q = rng.uniform(a1.JOINT_LOWER, a1.JOINT_UPPER, (n, 12))
    dq, ddq = rng.normal(size=(2, n, 12))

    def feet(t: float) -> np.ndarray:
        # Body angular velocity w + dw t: to second order the turn is exp(w t + dw t^2 / 2).
        turn = geometry.quat_from_rotvec(w * t + 0.5 * dw * t * t)
        base = v * t + 0.5 * a * t * t
        joints = q + dq * t + 0.5 * ddq * t * t
        return kinematics.foot_pos_w(base, geometry.quat_mul(quat, turn), joints)

    fields = dict(quat=quat, joint_pos=q, joint_vel=dq, joint_acc=ddq, ang_vel=w, ang_acc=dw)
    tensors = {k: torch.tensor(x) for k, x in {**fields, "lin_vel": v, "lin_acc": a}.items()}
    vel, acc = foot_motion(Motion(**tensors))
    np.testing.assert_allclose(vel.numpy(), (feet(h) - feet(-h)) / (2 * h), atol=1e-5)
    np.testing.assert_allclose(acc.numpy(), (feet(h) - 2 * feet(0.0) + feet(-h)) / h**2, atol=1e-4)


def test_weights_are_the_papers():
    w = LossWeights()
    assert (w.orientation, w.joint, w.foot_vel, w.foot_acc) == (0.3, 1.0, 0.001, 0.001)
