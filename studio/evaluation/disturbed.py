"""Clean reference motions → what a live retargeter might send, with or without consistency.

Spatial noise: Ornstein-Uhlenbeck on joints, tilt and height, as in training. Temporal noise: the
reference freezes for a moment, as when a camera loses the person, and then jumps to where they are.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from studio import geometry
from studio.control.observation_frame import level_quat, reference_frame
from studio.reference.consistency import limit_speed, make_consistent
from studio.reference.motion import ReferenceMotion, backward_difference
from studio.rl.bank import MotionBank
from studio.rl.noise import NoiseConfig, ou_step
from studio.robot import a1

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Disturbance:
    """sigma: rad, range of the joints' σ, drawn once a motion; tilt and height (m) take a share of
    it. freeze: a second, how often the reference stops; frozen: control periods it stops for.
    contact_noise: standard deviation of the contact probability's noise."""

    sigma: tuple[float, float] = NoiseConfig.joint_sigma
    tau: float = NoiseConfig.tau
    tilt_share: float = 0.4
    height_share: float = 0.1
    freeze: float = 0.5
    frozen: tuple[int, int] = (3, 12)
    contact_noise: float = 0.2


def disturbed(
    bank: MotionBank,
    rng: np.random.Generator,
    *,
    contact: bool,
    speed_limit: float,
    noise: Disturbance = Disturbance(),
) -> MotionBank:
    """The bank, its `seen` filled with disturbed references.

    contact: made contact-consistent. speed_limit: rad/s of the joints, infinite for none. The same
    rng state gives the same disturbance whatever is done about it.
    """
    level = np.array(level_quat(bank.state))
    seen = np.empty_like(bank.feature)
    for m in range(len(bank)):
        motion = _shaken(bank, m, rng, noise)
        if contact:
            motion = make_consistent(motion, speed_limit)
        elif np.isfinite(speed_limit):
            motion = _limited(motion, speed_limit)
        seen[m] = reference_frame(
            motion.joint_pos,
            motion.base_pos[:, 2],
            motion.base_quat,
            backward_difference(motion.base_pos, motion.dt),
            geometry.ang_vel_b(motion.base_quat, motion.dt),
            level,
        )
    seen[..., :12] = np.clip(seen[..., :12], a1.JOINT_LOWER, a1.JOINT_UPPER)
    return replace(bank, seen=seen)


def _shaken(
    bank: MotionBank, m: int, rng: np.random.Generator, noise: Disturbance
) -> ReferenceMotion:
    """Motion m with both kinds of noise."""
    frames = bank.frames
    sigma = rng.uniform(*noise.sigma)
    scale = sigma * np.concatenate(
        [np.ones(12), np.full(2, noise.tilt_share), [noise.height_share]]
    )
    value = np.empty((frames, 15))
    value[0] = scale * rng.standard_normal(15)
    for k in range(1, frames):
        value[k] = ou_step(value[None, k - 1], scale, noise.tau, a1.CONTROL_DT, rng)[0]
    source = _frozen(frames, rng, noise)
    label = bank.contact[m] + noise.contact_noise * rng.standard_normal((frames, 4))
    tilt = np.concatenate([value[:, 12:14], np.zeros((frames, 1))], axis=1)
    height = np.concatenate([np.zeros((frames, 2)), value[:, 14:]], axis=1)
    return ReferenceMotion(
        state=bank.state,
        task=bank.tasks[bank.task[m]],
        dt=a1.CONTROL_DT,
        base_pos=(bank.base_pos[m] + height)[source],
        base_quat=geometry.quat_mul(bank.base_quat[m], geometry.quat_from_rotvec(tilt))[source],
        joint_pos=(bank.joint_pos[m] + value[:, :12])[source],
        foot_contact=np.clip(label, 0.0, 1.0)[source],
        params={},
    )


def _frozen(frames: int, rng: np.random.Generator, noise: Disturbance) -> NDArray[np.intp]:
    """(T,) the frame that is seen at each control period."""
    source = np.arange(frames)
    k = 0
    while k < frames:
        k += 1 + int(rng.exponential(1.0 / noise.freeze) / a1.CONTROL_DT)
        length = int(rng.integers(*noise.frozen, endpoint=True))
        if k < frames:
            source[k : k + length] = k
        k += length
    return source


def _limited(motion: ReferenceMotion, speed_limit: float) -> ReferenceMotion:
    joints = np.empty_like(motion.joint_pos)
    last = motion.joint_pos[0]
    for k, asked in enumerate(motion.joint_pos):
        last, _ = limit_speed(asked, last, speed_limit, motion.dt)
        joints[k] = last
    return replace(motion, joint_pos=joints)
