"""Left and right exchanged: observations, actions and references as seen in a mirror."""

import numpy as np
from numpy.typing import NDArray

from studio.control.observation import FRAMES, PAST_ACTIONS, ObservationConfig
from studio.robot.a1 import MIRROR_JOINT, MIRROR_LEG, MIRROR_SIGN

Array = NDArray[np.float64]


def _block(extra_signs: list[float]) -> tuple[NDArray[np.intp], Array]:
    """Index and sign of 12 joints followed by scalars that keep their place."""
    index = np.concatenate([MIRROR_JOINT, 12 + np.arange(len(extra_signs))])
    return index, np.concatenate([MIRROR_SIGN, extra_signs])


def _repeat(index: NDArray[np.intp], sign: Array, times: int) -> tuple[NDArray[np.intp], Array]:
    size = len(index)
    return np.concatenate([index + k * size for k in range(times)]), np.tile(sign, times)


def observation_mirror(config: ObservationConfig) -> tuple[NDArray[np.intp], Array]:
    """(index, sign), each (dim,), no unit: mirrored = sign * observation[..., index]."""
    # z: roll, pitch, roll rate, pitch rate (, yaw rate); p̄: height, roll, pitch, yaw rate, v_x, v_y
    z = _repeat(*_block([-1.0, 1.0, -1.0, 1.0] + ([-1.0] if config.yaw_rate else [])), FRAMES)
    a = _repeat(*_block([]), PAST_ACTIONS)
    frames = FRAMES + len(config.future)
    p = _repeat(*_block([1.0, -1.0, 1.0, -1.0, 1.0, -1.0]), frames)
    index, offset = [], 0
    for part, _ in (z, a, p):
        index.append(part + offset)
        offset += len(part)
    return np.concatenate(index), np.concatenate([z[1], a[1], p[1]])


def privileged_mirror() -> tuple[NDArray[np.intp], Array]:
    """(index, sign), each (PRIVILEGED_DIM,), no unit, of `ImitationEnv.privileged`."""
    blocks = [
        (np.arange(3), np.array([1.0, -1.0, 1.0])),  # velocity
        (np.arange(1), np.ones(1)),  # height
        (np.arange(2), np.array([1.0, -1.0])),  # gap to the anchor
        (np.arange(1), -np.ones(1)),  # heading to the anchor
        *[(MIRROR_JOINT, MIRROR_SIGN)] * 3,  # joint error, reference ahead, joint velocity
        *[(np.arange(6), np.array([1.0, -1.0, 1.0, -1.0, 1.0, -1.0]))] * 2,  # rest of p̄ now, soon
        (MIRROR_LEG, np.ones(4)),  # contacts soon
        (np.arange(4), np.ones(4)),  # friction, kp, kd, delay
        (np.arange(2), np.array([-1.0, 1.0])),  # slope: a rotation vector, so x turns over
    ]
    index, offset = [], 0
    for part, _ in blocks:
        index.append(part + offset)
        offset += len(part)
    return np.concatenate(index), np.concatenate([sign for _, sign in blocks])
