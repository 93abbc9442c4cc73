"""A robot motion → what a mapper learns from it: pose, contacts and derivatives in a state's frame.

Shipped mappers (synthetic people) and a person's own (takes) learn from this one function.
"""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from studio import geometry
from studio.human.features import DELTA_FRAMES
from studio.reference.contact import contact_labels
from studio.reference.intent import StateName
from studio.reference.stances import facing
from studio.robot import a1, kinematics

Array = NDArray[np.float64]

DIMS: dict[str, int] = {
    "joint_pos": 12, "base_quat": 4, "base_pos": 3, "contact": 4, "joint_vel": 12, "joint_acc": 12,
    "base_lin_vel": 3, "base_lin_acc": 3, "base_ang_vel": 3, "base_ang_acc": 3,
}  # fmt: skip
"""The labels of a frame and how many numbers each has."""
_VECTOR, _AXIAL = np.array([1.0, -1.0, 1.0]), np.array([-1.0, 1.0, -1.0])
_QUAT = np.array([1.0, -1.0, 1.0, -1.0])


def label_motion(
    state: StateName, base_pos: Array, base_quat: Array, joint_pos: Array, dt: float
) -> dict[str, Array]:
    """DIMS of a motion (T, 3) m, (T, 4) wxyz, (T, 12) rad, in the world, a frame every dt s.

    base_quat (w >= 0) and the base's linear rates are in the state's frame: walking it turns with
    the heading, else it is the way the feet of the first frame face, so that yaw is the trunk's
    twist however the motion begins. Angular rates in the body, base_pos in the world. Backward
    differences over 0.1 s, as for the person. contact: in [0, 1], by height and speed of the feet.
    """
    back = np.maximum(np.arange(len(joint_pos)) - DELTA_FRAMES, 0)
    span = DELTA_FRAMES * dt

    def rate(x: Array) -> Array:
        return (x - x[back]) / span

    feet = kinematics.foot_pos_w(base_pos, base_quat, joint_pos)
    contact = contact_labels(feet, dt)
    if state == "walk":
        frame = geometry.heading_quat(base_quat)
    else:
        yaw = facing(state, feet[0], contact[0])
        frame = np.broadcast_to(geometry.quat_from_yaw(yaw), base_quat.shape)
    turn = geometry.quat_mul(geometry.quat_conj(base_quat[back]), base_quat)
    ang_vel = geometry.quat_to_rotvec(turn) / span
    lin_vel = rate(base_pos)
    return {
        "joint_pos": joint_pos,
        "base_quat": geometry.quat_positive(
            geometry.quat_mul(geometry.quat_conj(frame), base_quat)
        ),
        "base_pos": base_pos,
        "contact": contact,
        "joint_vel": rate(joint_pos),
        "joint_acc": rate(rate(joint_pos)),
        "base_lin_vel": geometry.quat_rotate_inverse(frame, lin_vel),
        "base_lin_acc": geometry.quat_rotate_inverse(frame, rate(lin_vel)),
        "base_ang_vel": ang_vel,
        "base_ang_acc": rate(ang_vel),
    }


def mirror_labels(labels: Mapping[str, NDArray]) -> dict[str, NDArray]:
    """The labels of the motion as its mirror image in the x-z plane makes it: left is right.

    Shapes, units and frames as those of `label_motion`.
    """

    def mirror(name: str, x: NDArray) -> NDArray:
        if name.startswith("joint"):
            return x[..., a1.MIRROR_JOINT] * a1.MIRROR_SIGN
        if name == "contact":
            return x[..., a1.MIRROR_LEG]
        if name == "base_quat":
            return x * _QUAT
        return x * (_AXIAL if name.startswith("base_ang") else _VECTOR)

    return {name: mirror(name, x).astype(x.dtype) for name, x in labels.items()}
