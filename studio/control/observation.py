"""Sensors, references and past actions → the policy's observation, the same live and in training.

o_t = [z_{t-3..t}, a_{t-3..t-1}, p̄_{t-3..t}] (the paper's section on motion imitation), oldest
first. z: 12 joint angles, roll, pitch, their rates and, by default, the gyro's yaw rate. p̄: 12
joint angles, base height, roll, pitch, yaw rate, planar velocity in the reference's heading frame.
"""

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from studio import geometry
from studio.control import odometry
from studio.errors import StudioError
from studio.reference import scalars
from studio.reference.intent import StateName
from studio.robot import a1

Array = NDArray[np.float64]

FRAMES = 4
"""Frames of z and of the reference in an observation."""
PAST_ACTIONS = 3
ACTION_DIM = 12
REFERENCE_DIM = 18
YAW_RATE, VELOCITY, GYRO_YAW = 15, slice(16, 18), 16
"""Places of yaw rate and planar velocity in p̄, and of the yaw rate in z."""
HEADING_CLIP = 0.35
"""rad; a larger error (a robot turned by hand, a fall) is not made up for."""
PLACE_CLIP = 0.25
"""m, likewise."""
MAKES_UP_FROM = 0.02
"""m/s asked for from which missed way is made up for in full; less at less."""


@cache
def level_quat(state: StateName) -> tuple[float, float, float, float]:
    """wxyz of the state's neutral trunk pitch, T_level_base.

    Tilt is measured about the neutral pose of a state: a sitting trunk is nearly vertical, where
    heading, roll and pitch of the trunk itself are singular.
    """
    from studio.reference.stances import NEUTRAL

    w, x, y, z = NEUTRAL[state].base_quat
    return float(w), float(x), float(y), float(z)


def roll_pitch(quat: Array, level: Array = geometry.IDENTITY_QUAT) -> Array:
    """(N, 2) rad, roll and pitch of the levelled trunk (N, 4) against its own world's vertical.

    With u the world's z in the levelled frame: roll = atan2(u_y, u_z), pitch = −asin u_x. level:
    (4,) T_level_base, the neutral tilt that is taken off.
    """
    up = geometry.up_in_body(quat) @ scalars.matrix(level.tolist()).T
    out = np.empty(up.shape[:-1] + (2,))
    out[..., 0] = np.arctan2(up[..., 1], up[..., 2])
    out[..., 1] = np.arcsin(np.minimum(np.maximum(-up[..., 0], -1.0), 1.0))
    return out


def heading_of(quat: Array, level: Array) -> Array:
    """(N,) rad heading of the trunk `quat` (N, 4) with the neutral tilt `level` (4,) taken off.

    The levelled x axis, seen from the trunk, is the first row of R(level); turned into the world
    and laid on the ground.
    """
    a, b, c = scalars.matrix(level.tolist())[0].tolist()
    w, x, y, z = quat[..., 0], quat[..., 1], quat[..., 2], quat[..., 3]
    east = (1 - 2 * (y * y + z * z)) * a + 2 * (x * y - w * z) * b + 2 * (x * z + w * y) * c
    north = 2 * (x * y + w * z) * a + (1 - 2 * (x * x + z * z)) * b + 2 * (y * z - w * x) * c
    return np.arctan2(north, east)


def sensor_frame(
    joint_pos: Array, imu_quat: Array, gyro_b: Array, level: Array, yaw_rate: bool = True
) -> Array:
    """z_t (N, 17), or the paper's (N, 16) without `yaw_rate`.

    joint_pos: (N, 12) rad. imu_quat: (N, 4), trunk in a frame whose z opposes gravity. gyro_b:
    (N, 3) rad/s, body. level: (4,) T_level_base of the state. The rates are those about the
    levelled trunk's x, y and z.
    """
    rates = gyro_b @ scalars.matrix(level.tolist()).T
    tilt = roll_pitch(imu_quat, level)
    return np.concatenate([joint_pos, tilt, rates if yaw_rate else rates[..., :2]], axis=-1)


def reference_frame(
    joint_pos: Array,
    base_height: Array,
    base_quat: Array,
    base_lin_vel_w: Array,
    base_ang_vel_b: Array,
    level: Array,
) -> Array:
    """p̄_t (N, 18) of reference poses: nothing in it needs odometry.

    joint_pos (N, 12) rad; base_height (N,) m; base_quat (N, 4) and base_lin_vel_w (N, 3) m/s in
    the world; base_ang_vel_b (N, 3) rad/s, body; level (4,) T_level_base. p̄: joints, height, roll
    and pitch, the rate about the world's z, the velocity ahead and to the left.
    """
    yaw = heading_of(base_quat, level)
    c, s = np.cos(yaw), np.sin(yaw)
    vx, vy = base_lin_vel_w[..., 0], base_lin_vel_w[..., 1]
    up = geometry.up_in_body(base_quat)
    rx, ry, rz = base_ang_vel_b[..., 0], base_ang_vel_b[..., 1], base_ang_vel_b[..., 2]
    out = np.empty(joint_pos.shape[:-1] + (REFERENCE_DIM,))
    out[..., :12] = joint_pos
    out[..., 12] = base_height
    out[..., 13:15] = roll_pitch(base_quat, level)
    # The vertical part of R(q) ω is the turning seen from above.
    out[..., 15] = up[..., 0] * rx + up[..., 1] * ry + up[..., 2] * rz
    out[..., 16] = c * vx + s * vy
    out[..., 17] = -s * vx + c * vy
    return out


@dataclass(frozen=True, kw_only=True)
class ObservationConfig:
    """What the policy sees.

    yaw_rate: add the gyro's yaw rate to z (the paper: no). heading_gain, place_gain: 1/s, how much
    of the errors of heading and place (see `History`) is added to the reference's yaw rate and
    velocity, 0 for none; hold_tau: s in which an error is forgotten; heading_smooth: s over which
    the heading's error is averaged before it steers, so that what the trunk yaws within a stride
    does not answer itself. future: control periods ahead of which p̄ is appended (only a simulation
    can know them).
    """

    yaw_rate: bool = True
    heading_gain: float = 0.0
    place_gain: float = 0.0
    hold_tau: float = 5.0
    heading_smooth: float = 0.0
    future: tuple[int, ...] = ()

    def __post_init__(self) -> None:
        if (self.heading_gain or self.place_gain) and not self.yaw_rate:
            raise StudioError("holding heading or place needs the gyro's yaw rate: leave it on")
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
        held = {"yaw_rate": ("heading", self.heading_gain), "vel": ("place", self.place_gain)}
        told = [f"{field} += gain * error of {of}" for field, (of, gain) in held.items() if gain]
        if told:
            p += f" ({', '.join(told)})"
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

    With gains g the reference's yaw rate ψ̄' and velocity v̄ enter as ψ̄' + g e and v̄ + g d, where e
    and d say how much less the robot has turned and gone than it was asked to, by its gyro and its
    legs (`odometry`) alone, forgotten with a time constant τ:

        e ← (1 − Δt/τ) (e + (ψ̄' − ω_z) Δt),                     |e| ≤ HEADING_CLIP
        d ← (1 − Δt/τ) (R(−ω_z Δt) d + R(e) v̄ Δt − odometry),    ‖d‖ ≤ PLACE_CLIP

    e steers as its first-order mean over heading_smooth. Below MAKES_UP_FROM d counts in proportion
    to the speed asked for.
    """

    def __init__(self, num_envs: int, config: ObservationConfig) -> None:
        self.config = config
        self.z = np.zeros((num_envs, FRAMES, config.sensor_dim))
        self.actions = np.zeros((num_envs, PAST_ACTIONS, ACTION_DIM))
        self._past = np.zeros((num_envs, FRAMES, REFERENCE_DIM))
        self.heading_error = np.zeros(num_envs)
        self.steering = np.zeros(num_envs)
        self.place_error = np.zeros((num_envs, 2))
        self._feet = np.zeros((num_envs, 4, 3))
        self._stood = np.zeros((num_envs, 4))

    @property
    def reference(self) -> Array:
        """(N, FRAMES, 18), oldest first."""
        return self._past

    def reset(
        self, ids: NDArray[np.intp] | slice, z: Array, reference: Array, contact: Array
    ) -> None:
        """Fill the history of n robots `ids` with one frame of each and no action.

        z (n, 16 or 17) of `sensor_frame`, reference (n, 18) of `reference_frame`, contact (n, 4).
        """
        self.z[ids] = z[:, None]
        self._past[ids] = reference[:, None]
        self.actions[ids] = 0.0
        self.heading_error[ids] = 0.0
        self.steering[ids] = 0.0
        self.place_error[ids] = 0.0
        if self.config.place_gain:
            self._feet[ids], self._stood[ids] = _footholds(z), contact

    def push(self, z: Array, reference: Array, contact: Array) -> None:
        """A new frame of every robot, as for `reset`; contact: 1 where a foot feels the ground."""
        self.z[:, :-1] = self.z[:, 1:]
        self.z[:, -1] = z
        self._past[:, :-1] = self._past[:, 1:]
        self._past[:, -1] = reference
        if self.config.heading_gain or self.config.place_gain:
            self._hold(z, reference, contact)

    def _hold(self, z: Array, reference: Array, contact: Array) -> None:
        """What the robot has missed, and the newest reference with it made up for."""
        config, dt = self.config, a1.CONTROL_DT
        keep = 1.0 - dt / config.hold_tau
        turn = z[:, GYRO_YAW] * dt
        error = keep * (self.heading_error + reference[:, YAW_RATE] * dt - turn)
        self.heading_error = np.minimum(np.maximum(error, -HEADING_CLIP), HEADING_CLIP)
        self.steering += (self.heading_error - self.steering) * dt / max(config.heading_smooth, dt)
        self._past[:, -1, YAW_RATE] += config.heading_gain * self.steering
        if config.place_gain:
            feet = _footholds(z)
            asked = odometry.turned(reference[:, VELOCITY] * dt, self.heading_error)
            gone = odometry.displacement(self._feet, feet, turn, self._stood * contact)
            self._feet, self._stood = feet, contact
            error = keep * (odometry.turned(self.place_error, -turn) + asked - gone)
            size = np.hypot(error[:, 0], error[:, 1])[:, None]
            self.place_error = error * (PLACE_CLIP / np.maximum(size, PLACE_CLIP))
            # Nobody who is told to stop still runs after what was missed.
            going = np.hypot(*reference[:, VELOCITY].T) / MAKES_UP_FROM
            gain = config.place_gain * np.minimum(going, 1.0)[:, None]
            self._past[:, -1, VELOCITY] += gain * self.place_error

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


def _footholds(z: Array) -> Array:
    return odometry.footholds(z[:, :12], z[:, 12], z[:, 13])
