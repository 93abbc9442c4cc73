"""How late a person was: the lag at which the shown robot motion explains the person best.

How likely each lag is, `likelihood` says. A gait is told by when feet leave the floor: a person's
foot stays up longer than the robot's, so that the middles of their steps do not coincide, but both
lift at the same beat.

One take is rarely enough for a frame's precision, since people sway as they act; the lag of a
person is the same all session, and the takes of a session together are (see `align`).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio import geometry
from studio.human.skeleton import INDEX
from studio.robot import a1, kinematics
from studio.takes.align import likelihood
from studio.takes.align.alignment import (
    MAX_LAG_S,
    MIN_LAG_S,
    Alignment,
    human_channels,
    robot_channels,
)

Array = NDArray[np.float64]

STEP_SHARES = (0.42, 0.46, 0.50)
"""How long a person's foot may be in the air, as a share of the stride."""
STILL = 0.003
"""m, rad, m/s: what spreads less than this does not move; quiet standing sways less."""
_LIFTED = 0.004
"""m: a sole this high has left the floor."""


@dataclass(frozen=True, kw_only=True)
class HumanSide:
    """channels (T, 7) of `alignment`; pose (T, 55): joints about the pelvis and its height, m."""

    channels: Array
    pose: Array


@dataclass(frozen=True, kw_only=True)
class RobotSide:
    """channels (T, 7) of `alignment`; shown (T, P): what the robot's pose says; lifts: times (s)
    at which the front (left, right) foot leaves the floor."""

    channels: Array
    shown: Array
    lifts: tuple[Array, Array]


def human_side(joint_pos: Array) -> HumanSide:
    """Of joints (T, 19, 3) m in any heading."""
    x = joint_pos - joint_pos[:, :1]
    side = np.median(x[:, INDEX["l_hip"]] - x[:, INDEX["r_hip"]], axis=0)
    x = geometry.quat_rotate_inverse(geometry.quat_from_yaw(np.arctan2(-side[0], side[1])), x)
    height = -x[:, [INDEX["l_ankle"], INDEX["r_ankle"]], 2].min(axis=1)
    pose = np.concatenate([x[:, 1:].reshape(len(x), -1), height[:, None]], axis=1)
    return HumanSide(channels=human_channels(joint_pos), pose=pose)


def robot_side(base_pos: Array, base_quat: Array, joint_pos: Array, contact: Array) -> RobotSide:
    """Of poses (T, 3), (T, 4), (T, 12) and contacts (T, 4) at 30 Hz."""
    foot = kinematics.foot_pos_w(base_pos, base_quat, joint_pos)
    walks = np.linalg.norm(base_pos[:, :2] - base_pos[0, :2], axis=-1).max() > 0.15
    if walks:
        yaw = np.unwrap(geometry.heading(base_quat))
        ahead = np.stack([np.cos(yaw), np.sin(yaw)], axis=-1)
        vel = np.gradient(base_pos[:, :2], a1.CONTROL_DT, axis=0)
        speed = _smooth(np.einsum("ti,ti->t", vel, ahead))
        columns = [speed, _smooth(np.gradient(yaw, a1.CONTROL_DT)), base_pos[:, 2]]
    else:
        # About the first pose: upright in sit, Euler angles of the trunk are singular.
        tilt = geometry.quat_to_rotvec(
            geometry.quat_mul(geometry.quat_conj(base_quat[:1]), base_quat)
        )
        paw = foot[:, :2] - base_pos[:, None]
        columns = [*tilt.T, base_pos[:, 2], *paw.reshape(len(paw), 6).T]
    lifts = _lift_offs(foot[:, 1, 2]), _lift_offs(foot[:, 0, 2])
    gait = walks or min(len(lifts[0]), len(lifts[1])) >= 2
    return RobotSide(
        channels=robot_channels(base_pos, base_quat, joint_pos, contact),
        shown=np.stack(columns, axis=-1),
        lifts=lifts if gait else (np.zeros(0), np.zeros(0)),
    )


def _smooth(x: Array) -> Array:
    kernel = np.hanning(11) / np.hanning(11).sum()
    return np.asarray(np.convolve(np.pad(x, 5, mode="edge"), kernel, "valid"), dtype=np.float64)


def _lift_offs(foot_z: Array) -> Array:
    """Times (s) at which a sole rises over _LIFTED, between frames by a straight line."""
    z = foot_z - a1.FOOT_RADIUS - _LIFTED
    i = np.flatnonzero((z[:-1] <= 0.0) & (z[1:] > 0.0))
    # The foot rises smoothly from rest: it left the floor about a frame before.
    return (i + z[i] / (z[i] - z[i + 1]) - 0.5) * a1.CONTROL_DT


def _steps(lifts: tuple[Array, Array], n: int, share: float) -> Array:
    """(T, 2) how high a person who lifts (left, right) at these times has the feet, [0, 1]."""
    t, out = np.arange(n) * a1.CONTROL_DT, np.zeros((n, 2))
    beats = np.sort(np.concatenate(lifts))
    for foot, own in enumerate(lifts):
        for lift in own:
            later = beats[beats > lift + 0.1]
            earlier = beats[beats < lift - 0.1]
            halves = [*(later[:1] - lift), *(lift - earlier[-1:])]
            half = min([*halves, 1.7])
            u = np.clip((t - lift) / (2.0 * share * half), 0.0, 1.0)
            out[:, foot] += np.sin(np.pi * u) ** 2
    return out


@dataclass(frozen=True, kw_only=True)
class Curve:
    """lags (K,) frames, ascending; level (K,) log likelihood by this take alone; place (K,) what
    it adds to others of its session (see `align`); explained (K,) share in [0, 1]."""

    lags: Array
    level: Array
    place: Array
    explained: Array


def curve(human: HumanSide, robot: RobotSide, dt: float) -> Curve | None:
    """How likely every lag of MIN_LAG_S to MAX_LAG_S is; None when nothing moves.

    Takes are at rest at both ends: there, the last pose is taken to last.
    """
    lags = np.arange(round(MIN_LAG_S / dt), round(MAX_LAG_S / dt) + 1)
    return _likelihood(human, robot, dt, lags.astype(np.float64))


def align(human: HumanSide, robot: RobotSide, dt: float, others: Sequence[Curve] = ()) -> Alignment:
    """The likeliest lag; lag, correlation and certainty 0 if nothing moves.

    others: curves of more takes by the same person in the same session. Reaction and sensor are
    late alike in all of them, so their likelihoods add up.
    """
    own = curve(human, robot, dt)
    if own is None:
        return Alignment(lag=0.0, correlation=0.0, certainty=0.0)
    level = own.level
    if others:
        # Speeds claim more than they know: one take that errs would outvote five.
        level = own.place + sum((c.place - c.place.max() for c in others), np.zeros(len(own.lags)))
    best = int(np.argmax(level))
    share = np.exp(level - level.max())
    return Alignment(
        lag=float((own.lags[best] + _vertex(level, best)) * dt),
        correlation=float(np.sqrt(max(0.0, own.explained[best]))),
        certainty=float(share[max(0, best - 1) : best + 2].sum() / share.sum()),
    )


def agreement(human: HumanSide, robot: RobotSide, dt: float, lag: float) -> Alignment:
    """How well a given lag explains the person; certainty is not judged (1)."""
    found = _likelihood(human, robot, dt, np.array([round(lag / dt)]))
    if found is None:
        return Alignment(lag=lag, correlation=0.0, certainty=0.0)
    return Alignment(
        lag=lag, correlation=float(np.sqrt(max(0.0, found.explained[0]))), certainty=1.0
    )


def _likelihood(human: HumanSide, robot: RobotSide, dt: float, lags: Array) -> Curve | None:
    n = min(len(human.pose), len(robot.shown))
    shown = _scaled(robot.shown[:n])
    gait = len(robot.lifts[0]) > 0
    if n < 30 or (shown.shape[1] == 0 and not gait):
        return None
    steps = [_steps(robot.lifts, n, share) for share in STEP_SHARES] if gait else []
    try:
        level, place, explained = likelihood.levels(human.pose[:n], shown, steps, lags)
    except ValueError:
        return None
    return Curve(lags=lags, level=level, place=place, explained=explained)


def _scaled(x: Array) -> Array:
    """Columns that change, as z-scores."""
    spread = x.std(axis=0)
    moving = spread > STILL
    return (x[:, moving] - np.median(x[:, moving], axis=0)) / spread[moving]


def _vertex(score: Array, i: int) -> float:
    """Offset of the parabola's vertex through three neighbours, in samples; 0 at an end."""
    if not 0 < i < len(score) - 1:
        return 0.0
    a, b, c = score[i - 1 : i + 2]
    bend = a - 2 * b + c
    return float(np.clip(0.5 * (a - c) / bend, -0.5, 0.5)) if bend < -1e-12 else 0.0
