"""A controller that cheats: it sees the clean reference, its future and the legs' loads.

Its target is the clean reference `lead` periods ahead, which makes up for the low-pass, plus a
share of the angle by which a PD gives way under the weight:

    τ_i = −J_i^T R^T f_i,   f_i = m g c_i / Σc (upwards),   Δq = sag · τ / kp

with the legs' Jacobians J, the trunk's orientation R and the reference's contacts c. At test time
nobody knows these; a policy learns from it what they look like in noisy sensors and references.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio import geometry
from studio.control.action import ACTION_CLIP
from studio.rl.env import ImitationEnv
from studio.robot import a1, kinematics

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class TeacherConfig:
    """lead: control periods (67 ms: low-pass 41 ms and the PD's own lag). sag: share of the full
    load that is compensated; a stiffer stance tracks closer and tips earlier."""

    lead: int = 2
    sag: float = 0.5


def load_torque(joint_pos: Array, base_quat: Array, contact: Array) -> Array:
    """(N, 12) N m that hold the robot's weight, shared evenly by the feet in contact (N, 4)."""
    share = contact / np.maximum(contact.sum(axis=-1, keepdims=True), 1.0)
    up_b = geometry.quat_rotate_inverse(
        base_quat,
        np.broadcast_to([0.0, 0.0, a1.TOTAL_MASS * a1.GRAVITY], base_quat.shape[:-1] + (3,)),
    )
    force = share[..., None] * up_b[:, None, :]
    jacobian = kinematics.leg_jacobian(joint_pos)
    return -np.einsum("nlij,nli->nlj", jacobian, force).reshape(joint_pos.shape)


def teacher_action(env: ImitationEnv, config: TeacherConfig = TeacherConfig()) -> Array:
    """(N, 12), the action whose target is the teacher's, whatever noise the reference carries."""
    bank, m = env.bank, env.motion
    ahead = np.minimum(env.frame + config.lead, bank.frames - 1)
    joint_pos = bank.joint_pos[m, ahead]
    torque = load_torque(joint_pos, bank.base_quat[m, ahead], bank.contact[m, ahead])
    target = joint_pos + config.sag * torque / a1.KP
    base = env.noisy_joint_pos if env.config.action.mode == "residual" else env.neutral
    return np.clip((target - base) / env.config.action.scale, -ACTION_CLIP, ACTION_CLIP)
