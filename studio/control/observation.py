"""Sensors, references and past actions → the policy's observation, the same live and in training.

o_t = [z_{t-3..t}, a_{t-3..t-1}, p̄_{t-3..t}] (the paper's section on motion imitation), oldest
first. z and p̄ of one period: `observation_frame`.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.control.observation_frame import REFERENCE_DIM
from studio.errors import StudioError
from studio.robot import a1

Array = NDArray[np.float64]

FRAMES = 4
"""Frames of z and of the reference in an observation."""
PAST_ACTIONS = 3
ACTION_DIM = 12
YAW_RATE, GYRO_YAW = 15, 16
"""Places of the yaw rate in p̄ and in z."""
HEADING_CLIP = 0.35
"""rad; a larger error (a robot turned by hand, a fall) is not made up for."""


@dataclass(frozen=True, kw_only=True)
class ObservationConfig:
    """What the policy sees.

    yaw_rate: add the gyro's yaw rate to z (the paper: no). heading_gain: 1/s, how much of the
    heading's error (see `History`) is added to the reference's yaw rate, 0 for none; hold_tau: s in
    which an error is forgotten; heading_smooth: s over which it is averaged before it steers, so
    that what the trunk yaws within a stride does not answer itself. future: control periods ahead
    of which p̄ is appended (only a simulation can know them).
    """

    yaw_rate: bool = True
    heading_gain: float = 0.0
    hold_tau: float = 5.0
    heading_smooth: float = 0.0
    future: tuple[int, ...] = ()

    def __post_init__(self) -> None:
        if self.heading_gain and not self.yaw_rate:
            raise StudioError("holding the heading needs the gyro's yaw rate: leave it on")
        object.__setattr__(self, "future", tuple(self.future))  # a list, from JSON

    @property
    def sensor_dim(self) -> int:
        """Length of one z."""
        return 17 if self.yaw_rate else 16

    @property
    def dim(self) -> int:
        """Length of an observation."""
        past = FRAMES * (self.sensor_dim + REFERENCE_DIM) + PAST_ACTIONS * ACTION_DIM
        return past + REFERENCE_DIM * len(self.future)

    def manifest(self) -> list[dict[str, object]]:
        """Name, frames and length of each block in order, for whoever runs the policy alone."""
        z = "joint_pos[12] roll pitch roll_rate pitch_rate" + (" yaw_rate" if self.yaw_rate else "")
        p = "joint_pos[12] base_height roll pitch yaw_rate vel_forward vel_left"
        if self.heading_gain:
            p += " (yaw_rate += gain * error of heading)"
        blocks: list[dict[str, object]] = [
            {"name": "z", "frames": "t-3..t", "fields": z, "size": FRAMES * self.sensor_dim},
            {"name": "a", "frames": "t-3..t-1", "fields": "action[12]", "size": 36},
            {"name": "p_ref", "frames": "t-3..t", "fields": p, "size": FRAMES * REFERENCE_DIM},
        ]
        if self.future:
            frames = ", ".join(f"t+{k}" for k in self.future)
            size = REFERENCE_DIM * len(self.future)
            blocks.append({"name": "future", "frames": frames, "fields": p, "size": size})
        return blocks


class History:
    """The last frames of N robots; one thread only.

    With a gain g the reference's yaw rate ψ̄' enters as ψ̄' + g e, where e says how much less the
    robot has turned than it was asked to, by its gyro alone, forgotten with a time constant τ:

        e ← (1 − Δt/τ) (e + (ψ̄' − ω_z) Δt),    |e| ≤ HEADING_CLIP

    e steers as its first-order mean over heading_smooth.
    """

    def __init__(self, num_envs: int, config: ObservationConfig) -> None:
        self.config = config
        self.z = np.zeros((num_envs, FRAMES, config.sensor_dim))
        self.actions = np.zeros((num_envs, PAST_ACTIONS, ACTION_DIM))
        self._past = np.zeros((num_envs, FRAMES, REFERENCE_DIM))
        self.heading_error = np.zeros(num_envs)
        self.steering = np.zeros(num_envs)

    @property
    def reference(self) -> Array:
        """(N, FRAMES, 18), oldest first."""
        return self._past

    def reset(self, ids: NDArray[np.intp] | slice, z: Array, reference: Array) -> None:
        """Fill the history of n robots `ids` with one frame of each and no action.

        z (n, 16 or 17) of `sensor_frame`, reference (n, 18) of `reference_frame`.
        """
        self.z[ids] = z[:, None]
        self._past[ids] = reference[:, None]
        self.actions[ids] = 0.0
        self.heading_error[ids] = 0.0
        self.steering[ids] = 0.0

    def push(self, z: Array, reference: Array) -> None:
        """A new frame of every robot, as for `reset`."""
        self.z[:, :-1] = self.z[:, 1:]
        self.z[:, -1] = z
        self._past[:, :-1] = self._past[:, 1:]
        self._past[:, -1] = reference
        if self.config.heading_gain:
            self._hold(z, reference)

    def _hold(self, z: Array, reference: Array) -> None:
        """What the robot has missed, and the newest reference with it made up for."""
        config, dt = self.config, a1.CONTROL_DT
        keep = 1.0 - dt / config.hold_tau
        turn = z[:, GYRO_YAW] * dt
        error = keep * (self.heading_error + reference[:, YAW_RATE] * dt - turn)
        self.heading_error = np.minimum(np.maximum(error, -HEADING_CLIP), HEADING_CLIP)
        self.steering += (self.heading_error - self.steering) * dt / max(config.heading_smooth, dt)
        self._past[:, -1, YAW_RATE] += config.heading_gain * self.steering

    def push_action(self, action: Array) -> None:
        """The action (N, 12) decided on the present observation."""
        self.actions[:, :-1] = self.actions[:, 1:]
        self.actions[:, -1] = action

    def observation(
        self, future: Array | None = None, ids: NDArray[np.intp] | slice = slice(None)
    ) -> NDArray[np.float32]:
        """o_t (n, dim) float32 of the robots `ids`, by default of all N.

        future: (n, 18 · len(future)), where the configuration asks for it.
        """
        blocks = (self.z[ids], self.actions[ids], self._past[ids])
        parts = [block.reshape(len(block), -1) for block in blocks]
        if self.config.future:
            assert future is not None
            parts.append(future)
        return np.concatenate(parts, axis=1, dtype=np.float32)
