"""The studio's figures, each defined once: arrays over control periods to numbers.

A metric compares a robot with its clean reference of the same control step. Leading axis T is
time at the control rate; poses are base_pos (T, 3), base_quat (T, 4), feet in the base's heading
frame. Every function takes arrays only, so that tables, sidecars, training and the live view agree;
where a shape says (T, ...), further axes are robots beside each other.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from studio import geometry

Array = NDArray[np.float64]

TRACKED_FOOT_ERROR = 0.08
"""m: beyond this mean foot error a period is not tracked."""
TRACKED_TILT_DEG = 15.0
"""Beyond this orientation error, degrees, a period is not tracked."""
FALLEN_TILT_DEG = 60.0
"""A tilt this far from the reference's is a fall, degrees."""
_FALLEN_COS = float(np.cos(np.radians(FALLEN_TILT_DEG)))
_TRACKED_TILT = float(np.radians(TRACKED_TILT_DEG))
ANGLE_TOLERANCE = 0.02
"""rad: how far the simulated robot may pass a joint limit (its stops are springs)."""
RATE_TOLERANCE = 1.01
"""How far torque and joint speed may pass their limits (a factor)."""


def _array(x: ArrayLike) -> Array:
    return np.asarray(x, dtype=np.float64)


def joint_error_sq(joint_pos: ArrayLike, reference: ArrayLike) -> Array:
    """Mean square (...) rad² over the joints of (..., 12) rad against (..., 12) rad."""
    return np.mean((_array(joint_pos) - _array(reference)) ** 2, axis=-1)


def rms_deg(mean_square: float) -> float:
    """Degrees of the root of a mean of squares in rad², such as of `joint_error_sq`."""
    return float(np.degrees(np.sqrt(mean_square)))


def joint_rmse_deg(joint_pos: ArrayLike, reference: ArrayLike) -> float:
    """Root mean square over periods and joints of (T, 12) rad against (T, 12) rad, in degrees."""
    return rms_deg(float(np.mean(joint_error_sq(joint_pos, reference))))


def feet_apart(feet: ArrayLike, reference: ArrayLike) -> Array:
    """Mean over the feet (...) m of the distances of (..., 4, 3) and (..., 4, 3), both in a frame
    that moves and turns with its robot."""
    return np.mean(np.linalg.norm(_array(feet) - _array(reference), axis=-1), axis=-1)


def heading_frame(base_pos: ArrayLike, base_quat: ArrayLike, points_w: ArrayLike) -> Array:
    """Points (..., N, 3) from the world to the base's heading frame (yaw only, base origin)."""
    relative = _array(points_w) - _array(base_pos)[..., None, :]
    return geometry.quat_rotate_inverse(geometry.heading_quat(base_quat)[..., None, :], relative)


def foot_error_m(
    base_pos: ArrayLike,
    base_quat: ArrayLike,
    foot_pos_w: ArrayLike,
    reference_base_pos: ArrayLike,
    reference_base_quat: ArrayLike,
    reference_foot_pos_w: ArrayLike,
) -> float:
    """Mean over periods and feet, m, between feet relative to the base, in heading frames."""
    ours = heading_frame(base_pos, base_quat, foot_pos_w)
    theirs = heading_frame(reference_base_pos, reference_base_quat, reference_foot_pos_w)
    return float(np.mean(feet_apart(ours, theirs)))


def orientation_error(base_quat: ArrayLike, reference: ArrayLike) -> Array:
    """Angle (...) rad between the verticals that two bodies feel: tilt without heading.

    The angle between R^T z and R_ref^T z is defined at every tilt (heading is not, near vertical).
    """
    ours, theirs = geometry.up_in_body(base_quat), geometry.up_in_body(reference)
    cross = np.linalg.norm(np.cross(ours, theirs), axis=-1)
    return np.arctan2(cross, np.sum(ours * theirs, axis=-1))


def orientation_error_deg(base_quat: ArrayLike, reference: ArrayLike) -> float:
    """`orientation_error` averaged over the periods, degrees."""
    return float(np.degrees(np.mean(orientation_error(base_quat, reference))))


def contact_f1(contact: ArrayLike, reference: ArrayLike) -> float:
    """F1 of simulated contacts (T, 4) against those asked for (T, 4), both read at 0.5.

    1 where neither has any: nothing was asked, nothing was missed.
    """
    ours, asked = _array(contact) > 0.5, _array(reference) > 0.5
    both, total = np.sum(ours & asked), np.sum(ours) + np.sum(asked)
    return float(2.0 * both / total) if total else 1.0


def foot_skate_m_s(foot_pos_w: ArrayLike, contact: ArrayLike, dt: float) -> float:
    """Mean horizontal speed, m/s, of feet (T, 4, 3) in contact (T, 4) before and after the step.

    0 where no foot stays in contact over a period.
    """
    moved = np.linalg.norm(np.diff(_array(foot_pos_w)[..., :2], axis=0), axis=-1)
    on = _array(contact) > 0.5
    stays = on[1:] & on[:-1]
    return float(np.mean(moved[stays]) / dt) if np.any(stays) else 0.0


def limit_violations(
    target: ArrayLike,
    joint_pos: ArrayLike,
    joint_vel: ArrayLike,
    torque: ArrayLike,
    *,
    lower: ArrayLike,
    upper: ArrayLike,
    speed_limit: ArrayLike,
    torque_limit: ArrayLike,
) -> int:
    """Periods (of T) with a violated limit; all arrays (T, 12), limits (12,).

    A target passes a joint limit at all; the simulated robot passes one by more than 0.02 rad, or
    1 % of torque or joint speed.
    """
    lower, upper = _array(lower), _array(upper)
    eps = 1e-9
    bad = (_array(target) < lower - eps) | (_array(target) > upper + eps)
    pos = _array(joint_pos)
    bad |= (pos < lower - ANGLE_TOLERANCE) | (pos > upper + ANGLE_TOLERANCE)
    bad |= np.abs(_array(joint_vel)) > RATE_TOLERANCE * _array(speed_limit)
    bad |= np.abs(_array(torque)) > RATE_TOLERANCE * _array(torque_limit)
    return int(np.sum(np.any(bad, axis=-1)))


def distance_m(base_pos: ArrayLike) -> float:
    """Length m of the base's path over the ground, (T, 3)."""
    return float(np.sum(np.linalg.norm(np.diff(_array(base_pos)[:, :2], axis=0), axis=-1)))


def net_distance_m(base_pos: ArrayLike) -> float:
    """m over the ground from the first to the last of (T, 3): what of `distance_m` is no wobble."""
    pos = _array(base_pos)[:, :2]
    return float(np.linalg.norm(pos[-1] - pos[0])) if len(pos) else 0.0


def heading_change_deg(base_quat: ArrayLike) -> float:
    """Degrees the heading of (T, 4) turned in all, left positive; whole turns count."""
    yaw = np.unwrap(geometry.heading(base_quat))
    return float(np.degrees(yaw[-1] - yaw[0])) if len(yaw) else 0.0


def mean_speed_m_s(base_pos: ArrayLike, dt: float) -> float:
    """`distance_m` over the time it took, m/s; 0 for fewer than two periods."""
    steps = len(_array(base_pos)) - 1
    return distance_m(base_pos) / (steps * dt) if steps > 0 else 0.0


def joint_speed_deg_s(joint_pos: ArrayLike, dt: float) -> Array:
    """Speed (T - 1,) degrees a second of the fastest joint, by differences of (T, 12) rad."""
    moved = np.abs(np.diff(_array(joint_pos), axis=0))
    return np.degrees(moved.max(axis=-1, initial=0.0)) / dt


def rms_jerk(joint_pos: ArrayLike, dt: float) -> float:
    """Root mean square, rad/s³, over periods and joints of (T, J) rad, `dt` s apart, T over 3."""
    jerk = np.diff(_array(joint_pos), n=3, axis=0) / dt**3
    return float(np.sqrt(np.mean(jerk**2)))


def lag_periods(joint_pos: ArrayLike, reference: ArrayLike, most: int) -> int:
    """By how many periods, `most` at most, joints (T, J) trail those asked for: least squares."""
    ours, asked = np.asarray(joint_pos), np.asarray(reference)
    apart = [np.mean((ours[k:] - asked[: len(asked) - k]) ** 2) for k in range(most + 1)]
    return int(np.argmin(apart))


def fallen(trunk_contact: ArrayLike, base_quat: ArrayLike, reference: ArrayLike) -> NDArray:
    """Trunk on something, or tilt over 60 degrees from the reference's: bools (...).

    Not over the vertical: a sitting trunk is steep. Compares cosines, since the control loop asks
    once a period.
    """
    up, asked = geometry.up_in_body(base_quat), geometry.up_in_body(reference)
    return np.asarray(trunk_contact, dtype=bool) | (np.sum(up * asked, axis=-1) < _FALLEN_COS)


def tracked(foot_error: ArrayLike, orientation_error: ArrayLike) -> NDArray[np.bool_]:
    """Foot error (...) m under 8 cm and tilt error (...) rad under 15 degrees: bools (...)."""
    close = _array(foot_error) < TRACKED_FOOT_ERROR
    return close & (_array(orientation_error) < _TRACKED_TILT)


def success_time_ratio(fallen: ArrayLike, periods: int | None = None) -> Array:
    """Time until the first fall over the episode (...): fallen (T, ...) over `periods`, or T."""
    alive = _alive(fallen)
    return np.sum(alive, axis=0) / max(len(alive) if periods is None else periods, 1)


def tracked_time_ratio(
    fallen: ArrayLike,
    foot_error: ArrayLike,
    orientation_error: ArrayLike,
    periods: int | None = None,
) -> Array:
    """Share (...) of the episode (T or `periods`) that is alive and `tracked`, of (T, ...) each."""
    alive = _alive(fallen)
    good = alive & tracked(foot_error, orientation_error)
    return np.sum(good, axis=0) / max(len(alive) if periods is None else periods, 1)


def _alive(fallen: ArrayLike) -> NDArray[np.bool_]:
    """(T, ...) before the first fall."""
    return ~np.logical_or.accumulate(np.asarray(fallen, dtype=bool), axis=0)


def mean_velocity(pos: Array, yaw: Array, dt: float) -> Array:
    """(3,) m/s forward, m/s to the left, rad/s to the left: means over places `dt` s apart.

    pos: (T, 2) m, world. yaw: (T,) rad, unwrapped. Each step in the heading half way through it.
    """
    way, middle = np.diff(pos, axis=0), 0.5 * (yaw[1:] + yaw[:-1])
    forward, left = geometry.turn_xy(way, -middle).sum(axis=0)
    return np.array([forward, left, yaw[-1] - yaw[0]]) / (dt * len(way))
