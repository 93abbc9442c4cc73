"""A simulated robot's whole state as a teacher sees it, and a teacher that learnt to use it.

Where the analytic teacher (`teacher`) has no sense of balance, as sitting on slopes, one is trained
instead: PPO on the clean reference with the simulation's own state in sight ("learning by
cheating"). It has nothing to guess, so it soon learns precisely; a policy that sees only sensors
and noise is then taught by it.
"""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from safetensors import SafetensorError
from safetensors.numpy import load_file

from studio import geometry
from studio.control.action import ACTION_CLIP
from studio.control.observation_frame import roll_pitch
from studio.control.policy import Network
from studio.errors import StudioError
from studio.rl.env import ImitationEnv
from studio.rl.robots import EVERYONE, PRIVILEGED_DIM, Robots

Array = NDArray[np.float64]
LATER = 6
"""Control periods of the farther of the two looks ahead; the nearer one is `privileged`'s."""
FULL_STATE_DIM = PRIVILEGED_DIM + 12 + 5 + 12 + 18


def full_state(env: ImitationEnv, ids: Robots = EVERYONE) -> NDArray[np.float32]:
    """(n, FULL_STATE_DIM) of robots `ids`: `privileged`, joints, tilt and turning of the levelled
    trunk against the ground, the PD targets in force less the joints, and the clean reference LATER
    periods ahead, its joints less the present ones."""
    w, bank, m = env.world, env.bank, env.motion[ids]
    joint_pos = w.joint_pos[ids]
    later = np.minimum(env.frame[ids] + LATER, bank.frames - 1)
    rates = geometry.quat_rotate(env.level, w.base_ang_vel_b[ids])
    ahead = bank.feature[m, later].copy()
    ahead[:, :12] -= bank.joint_pos[m, env.frame[ids]]
    parts = [
        env.privileged(ids),
        joint_pos,
        roll_pitch(w.base_quat[ids], env.level),
        rates,
        w.target[ids] - joint_pos,
        ahead,
    ]
    return np.concatenate(parts, axis=1, dtype=np.float32)


class PrivilegedEnv(ImitationEnv):
    """The environment of a teacher in training: it observes the full state."""

    def observation(self, ids: Robots = EVERYONE) -> NDArray[np.float32]:
        """(n, FULL_STATE_DIM), of robots `ids`."""
        return full_state(self, ids)


class LearnedTeacher:
    """The weights of a privileged run as a teacher of others."""

    def __init__(self, path: Path) -> None:
        try:
            tensors = load_file(path)
            self.network = Network(tensors)
        except (OSError, SafetensorError, KeyError) as error:
            raise StudioError(
                f"no teacher in {path} ({error}); make one with train policy --privileged"
            ) from error
        if len(self.network.mean) != FULL_STATE_DIM:
            raise StudioError(f"{path} sees {len(self.network.mean)} figures, not {FULL_STATE_DIM}")

    def __call__(self, env: ImitationEnv) -> Array:
        """(N, 12): the action whose target is the teacher's, whatever noise the reference has."""
        own = np.clip(self.network(full_state(env)).astype(np.float64), -ACTION_CLIP, ACTION_CLIP)
        scale = env.config.action.scale
        clean = env.bank.joint_pos[env.motion, env.frame]
        base = env.noisy_joint_pos if env.config.action.mode == "residual" else env.neutral
        return np.clip(own + (clean - base) / scale, -ACTION_CLIP, ACTION_CLIP)
