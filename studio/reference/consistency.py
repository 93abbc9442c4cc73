"""Temporal consistency: joints and trunk keep to a speed limit; a whole motion, contacts too."""

import math

import numpy as np
from numpy.typing import NDArray

from studio.geometry import scalars
from studio.reference.contact_lock import ContactConfig, ContactLock
from studio.reference.motion import ReferenceMotion

Array = NDArray[np.float64]


def limit_speed(joint_pos: Array, last: Array, speed_limit: float, dt: float) -> tuple[Array, bool]:
    """Temporal consistency: joints (12,) no further from `last` than speed_limit (rad/s) allows.

    A leg with one joint too fast is slowed as a whole: clipped joint by joint its foot would leave
    its way, through the floor at times. Second value: whether any leg was slowed.
    """
    step = speed_limit * dt
    delta = (joint_pos - last).reshape(4, 3)
    most = np.abs(delta).max(axis=1)
    if most.max() <= step + 1e-9:
        return joint_pos, False
    share = np.minimum(step / np.maximum(most, 1e-12), 1.0)
    return last + (share[:, None] * delta).ravel(), True


def limit_turn(base_quat: Array, last: Array, speed_limit: float, dt: float) -> tuple[Array, bool]:
    """An orientation (4,) no further from `last` than speed_limit (rad/s) allows; was it cut?"""
    start = last.tolist()
    vec = scalars.rotvec(scalars.mul(scalars.conj(start), base_quat.tolist()))
    angle = math.sqrt(vec[0] ** 2 + vec[1] ** 2 + vec[2] ** 2)
    step = speed_limit * dt
    if angle <= step + 1e-9:
        return base_quat, False
    share = step / angle
    part = scalars.from_rotvec([share * v for v in vec])
    return np.array(scalars.mul(start, part)), True


def make_consistent(
    motion: ReferenceMotion, speed_limit: float, config: ContactConfig | None = None
) -> ReferenceMotion:
    """A whole noisy reference made consistent, frame by frame and causally, as it is live.

    The trunk's orientation is kept; its position is carried anew by the standing feet.
    """
    lock = ContactLock(config)
    lock.reset(motion.base_pos[0])
    last = motion.joint_pos[0]
    base_pos, joints = np.empty_like(motion.base_pos), np.empty_like(motion.joint_pos)
    contact = np.empty_like(motion.foot_contact)
    drift = motion.base_lin_vel_w
    for i in range(len(motion)):
        quat = motion.base_quat[i]
        asked = lock.step(motion.joint_pos[i], quat, motion.foot_contact[i], motion.dt, drift[i])
        last, clipped = limit_speed(asked, last, speed_limit, motion.dt)
        if clipped:
            lock.recheck(last, quat)
        base_pos[i], joints[i], contact[i] = lock.base_pos, last, lock.locked
    return ReferenceMotion(
        state=motion.state,
        task=motion.task,
        dt=motion.dt,
        base_pos=base_pos,
        base_quat=motion.base_quat,
        joint_pos=joints,
        foot_contact=contact,
        params=motion.params,
    )
