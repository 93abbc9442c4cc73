"""Phase and cadence to gait: when each foot swings, how far it may step, how the body sways.

The phase counts strides; its fraction says where in the stride the robot is, so a person's march,
pauses included, drives it directly. Up to 1 Hz one foot swings at a time (duty 0.82, order
FL RR FR RL, the lateral sequence of walking animals); from 1.4 Hz it is a trot (duty 0.6, diagonal
feet together). In between duty and offsets blend, so the order never jumps.

Sway: the zero moment point (ZMP) should sit on the side of the standing feet. It is told as a few
harmonics of the phase; the centre of mass follows by the linear inverted pendulum, which divides
the n-th harmonic by 1 + (2 pi n f)^2 h / g: wide and slow sway at 0.4 Hz, hardly any at 1.4 Hz.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from studio.reference.contact import smoothstep

Array = NDArray[np.float64]

CRAWL_CADENCE, TROT_CADENCE = 1.0, 1.4
"""Strides per second: one foot at a time up to the first, a trot from the second."""
CRAWL_DUTY, TROT_DUTY = 0.82, 0.60
"""Share of the stride that a foot stands."""
REAR_OFFSET = 0.28
"""Crawling, a rear foot swings this part of a stride after the front foot across."""
CRAWL_TRAVEL, TROT_TRAVEL = 0.30, 0.36
"""m: longest way of the body over a standing foot; longer, feet of one side would meet."""
MIN_CLEARANCE, MAX_CLEARANCE = 0.03, 0.08
"""m: height of a swinging sole for lift 0 and 1."""
MAX_SPEED = 0.97
"""m/s, the paper's fastest walk."""
MAX_YAW_PER_STRIDE = 0.5
"""rad: so 15 degrees a second need at least 0.53 strides a second."""
CROUCH_DROP = 0.05
"""m: how far crouch 1 lowers a walking trunk (0.27 to 0.22 m)."""

SWAY_Y, SWAY_X = 0.055, 0.010
"""m: amplitude of the ZMP's harmonics, to the side and along."""
_SWAY_CENTRE = 0.48  # phase in the middle of the swings of RR and FR: the body is left
_THIRD = -0.25  # share of the third harmonic: flattens the wave while feet swing
_HEIGHT_OVER_G = 0.26 / 9.81


REST_PHASE = 0.48
"""Phase (and half a stride on) at which every foot stands, at any cadence."""


def trot_share(cadence: ArrayLike) -> Array:
    """0 while feet swing one at a time, 1 in a trot, smooth in between."""
    span = TROT_CADENCE - CRAWL_CADENCE
    return smoothstep((np.asarray(cadence, dtype=np.float64) - CRAWL_CADENCE) / span)


def duty(share: ArrayLike) -> Array:
    """Share (...) of the stride a foot stands, for a share (...) of trot."""
    return CRAWL_DUTY + (TROT_DUTY - CRAWL_DUTY) * np.asarray(share, dtype=np.float64)


def leg_offsets(share: ArrayLike) -> Array:
    """Phase (..., 4) at which the feet FR FL RR RL leave the floor, for a share (...) of trot."""
    rear = REAR_OFFSET * (1.0 - np.asarray(share, dtype=np.float64))
    half = np.full_like(rear, 0.5)
    return np.stack([half, 0.0 * half, rear, half + rear], axis=-1)


def max_travel(share: ArrayLike) -> Array:
    """Longest way (...) m of the body over one standing foot, for a share (...) of trot."""
    return CRAWL_TRAVEL + (TROT_TRAVEL - CRAWL_TRAVEL) * np.asarray(share, dtype=np.float64)


def swing_profile(s: ArrayLike) -> Array:
    """Share of its way a foot has made at share s of its swing: speeds up, even, slows down.

    A trapezoid of speed: at most 4/3 of the mean, where minimum jerk would need 15/8 and, at
    0.97 m/s, joints past 900 degrees a second.
    """
    s = np.clip(np.asarray(s, dtype=np.float64), 0.0, 1.0)
    ramp, top = 0.25, 1.0 / 0.75
    early, late = 0.5 * top * s * s / ramp, 1.0 - 0.5 * top * (1.0 - s) ** 2 / ramp
    return np.where(s < ramp, early, np.where(s > 1.0 - ramp, late, top * (s - 0.5 * ramp)))


def speed_limit(cadence: ArrayLike) -> Array:
    """Fastest walk (...) m/s at a cadence: travel * cadence / duty, at most MAX_SPEED.

    0.15 m/s at 0.4 strides a second, 0.37 at 1, 0.84 at 1.4; MAX_SPEED needs 1.62.
    """
    cadence = np.asarray(cadence, dtype=np.float64)
    share = trot_share(cadence)
    return np.minimum(max_travel(share) * cadence / duty(share), MAX_SPEED)


def march_speed(cadence: ArrayLike, lift: ArrayLike) -> Array:
    """Speed (...) m/s meant by a march of this cadence and thigh lift (0 to 1).

    The step grows with the lift, fast at first: half of the longest at lift 0.3.
    """
    share = 1.0 - (1.0 - np.clip(np.asarray(lift, dtype=np.float64), 0.0, 1.0)) ** 2
    return share * speed_limit(cadence)


def march_lift(cadence: ArrayLike, speed: ArrayLike) -> Array:
    """Lift (...) at which a march of this cadence means this speed: undoes `march_speed`."""
    share = np.asarray(speed, dtype=np.float64) / np.maximum(speed_limit(cadence), 1e-9)
    return 1.0 - np.sqrt(1.0 - np.clip(share, 0.0, 1.0))


def clearance(lift: ArrayLike, cadence: ArrayLike) -> Array:
    """Height (...) m of a swinging sole; none at lift 0, where nothing is lifted.

    3 to 8 cm; quick feet rise less (5 cm at most from 2 strides a second): joint speed is limited.
    """
    lift = np.clip(np.asarray(lift, dtype=np.float64), 0.0, 1.0)
    quick = smoothstep(np.asarray(cadence, dtype=np.float64) - 1.0)
    most = MAX_CLEARANCE - 0.03 * quick
    return (MIN_CLEARANCE + (most - MIN_CLEARANCE) * lift) * smoothstep(lift / 0.1)


def sway(phase: ArrayLike, cadence: ArrayLike, share: ArrayLike) -> Array:
    """Offset (..., 2) m of the trunk along and to the left of its path."""
    phase, cadence = np.asarray(phase, dtype=np.float64), np.asarray(cadence, dtype=np.float64)
    turn = 2.0 * np.pi * (phase - _SWAY_CENTRE)
    lag = _HEIGHT_OVER_G * (2.0 * np.pi * cadence) ** 2
    side = np.cos(turn) / (1.0 + lag) + _THIRD * np.cos(3.0 * turn) / (1.0 + 9.0 * lag)
    along = np.sin(2.0 * (turn + 0.5 * np.pi)) / (1.0 + 4.0 * lag)
    still = 1.0 - np.asarray(share, dtype=np.float64)
    return still[..., None] * np.stack([SWAY_X * along, SWAY_Y * side], axis=-1)
