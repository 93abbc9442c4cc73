"""Phase and cadence to gait: when each foot swings, how far it may step, how the body sways.

The phase counts strides; its fraction says where in the stride the robot is, so a person's march,
pauses included, drives it directly. Up to 1 Hz one foot swings at a time (duty 0.87 to 0.8, order
FL RR FR RL, the lateral sequence of walking animals); from 1.4 Hz it is a trot (duty 0.6, diagonal
feet together). In between duty and offsets blend, so the order never jumps.

Sway: the zero moment point (ZMP) should sit on the side of the standing feet. It is told as a few
harmonics of the phase; the centre of mass follows by the linear inverted pendulum, which divides
the n-th harmonic by 1 + (2 pi n f)^2 h / g: wide and slow sway at 0.4 Hz, hardly any at 1.4 Hz.
"""

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from studio.geometry.time_scaling import smoothstep
from studio.robot import a1

Array = NDArray[np.float64]

_CADENCES = (0.3, 0.9, 1.4)
"""Strides per second of the slow crawl, the quick crawl and the trot, and for each of them: ..."""
_DUTIES = (0.87, 0.80, 0.60)
"""... the share of the stride that a foot stands,"""
_REAR_OFFSETS = (0.35, 0.28, 0.0)
"""and the part of a stride by which a rear foot swings after the front foot across. A slow crawl
has the time to swing quickly and to shift its weight in between."""
MAX_TRAVEL = 0.30
"""m: longest way of the body over a standing foot. Longer, feet of one side meet: played open loop,
a trot at 1.4 strides a second fell with 0.34."""
_TRAVELS = ((0.9, 1.2, 1.5, 1.9), (0.30, 0.26, 0.26, 0.28))
"""Strides per second, and the longest way there: between crawl and quick trot a step takes so long
that the robot tips over its diagonal; with 0.30 one playback in five fell there."""
STAGGER = 0.12
"""Share by which, at the longest travel, front feet step narrower and rear feet wider (16 mm): they
pass beside each other, and the trot goes straight."""
MIN_CLEARANCE, MAX_CLEARANCE = 0.03, 0.08
"""m: height of a swinging sole for lift 0 and 1."""
MAX_SPEED = 0.97
"""m/s, the paper's fastest walk."""
MAX_YAW_PER_STRIDE, MAX_YAW_TROTTING = 0.4, 0.65
"""rad: so 15 degrees a second need at least 0.65 strides a second, 60 (trotting) 1.6."""
MAX_BACK, MAX_SIDE = 0.4, 0.3
"""m/s: fastest walk backward and to a side."""
MAX_SIDESTEP = 0.14
"""m: longest way of the body sideways over a standing foot: farther, left and right feet meet."""
WAY_GAIN, TURN_GAIN = 0.20, 0.15
"""m and rad per stride by which the way and the turn of a stride may grow from stride to stride: a
foot is put down for the speed of the moment, and left behind when the body speeds up over it."""
HALF_WIDTH = 0.1308
"""m: from the middle to the feet of one side."""
WALKING_CROUCH = 0.05
"""m: how far crouch 1 lowers a walking trunk (0.27 to 0.22 m)."""

SWAY_Y, SWAY_X = 0.055, 0.025
"""m: amplitude of the ZMP's harmonics, to the side and along."""
FORWARD = 0.010
"""m: how far a walking trunk moves ahead of its feet: the centre of mass of the A1 lies behind the
trunk's origin (played open loop, the walk goes further)."""
_SWAY_CENTRE = 0.48  # phase in the middle of the swings of RR and FR: the body is left
_THIRD = -0.25  # share of the third harmonic: flattens the wave while feet swing
_HEIGHT_OVER_G = 0.26 / a1.GRAVITY


MARCH_CADENCES = (1.5, 1.7, 1.9, 2.1, 2.3)
"""Strides a second among which somebody chooses who is asked for a speed."""

REST_PHASE = 0.49
"""Phase (and half a stride on) at which every foot stands, at any cadence."""


def tempo(cadence: ArrayLike) -> Array:
    """Gait (...) of a cadence (...) in strides/s: 0 slow crawl, 0.5 quick crawl, 1 trot."""
    return np.interp(np.asarray(cadence, dtype=np.float64), _CADENCES, (0.0, 0.5, 1.0))


def trot_share(tempo: ArrayLike) -> Array:
    """Share (...): 0 while feet swing one at a time, 1 in a trot, smooth in between."""
    return smoothstep(2.0 * np.asarray(tempo, dtype=np.float64) - 1.0)


def duty(tempo: ArrayLike) -> Array:
    """Share (...) of the stride a foot stands."""
    return np.interp(np.asarray(tempo, dtype=np.float64), (0.0, 0.5, 1.0), _DUTIES)


def leg_offsets(tempo: ArrayLike) -> Array:
    """Phase (..., 4) at which the feet FR FL RR RL leave the floor."""
    rear = np.interp(np.asarray(tempo, dtype=np.float64), (0.0, 0.5, 1.0), _REAR_OFFSETS)
    half = np.full_like(rear, 0.5)
    return np.stack([half, 0.0 * half, rear, half + rear], axis=-1)


def max_travel(cadence: ArrayLike) -> Array:
    """Longest way (...) m of the body over one standing foot, at a cadence (...) strides/s."""
    return np.interp(np.asarray(cadence, dtype=np.float64), *_TRAVELS)


def swing_profile(s: ArrayLike) -> Array:
    """Share (...) of its way a foot has made at share s of its swing: quicker, even, slower.

    A trapezoid of speed: at most 4/3 of the mean, where minimum jerk would need 15/8 and, at
    0.97 m/s, joints past 900 degrees a second.
    """
    s = np.clip(np.asarray(s, dtype=np.float64), 0.0, 1.0)
    ramp, top = 0.25, 1.0 / 0.75
    early, late = 0.5 * top * s * s / ramp, 1.0 - 0.5 * top * (1.0 - s) ** 2 / ramp
    return np.where(s < ramp, early, np.where(s > 1.0 - ramp, late, top * (s - 0.5 * ramp)))


def speed_limit(cadence: ArrayLike, turn: ArrayLike = 0.0) -> Array:
    """Fastest walk (...) m/s at a cadence: travel * cadence / duty, at most MAX_SPEED.

    0.14 m/s at 0.4 strides a second, 0.34 at 0.9, 0.61 at 1.4; MAX_SPEED needs 2.08. Turning at
    `turn` rad/s takes a little of it away: the outer feet have further to go.
    """
    cadence = np.asarray(cadence, dtype=np.float64)
    longest = max_travel(cadence) * cadence / duty(tempo(cadence))
    return np.clip(longest - HALF_WIDTH * np.abs(turn), 0.0, MAX_SPEED)


def march_speed(cadence: ArrayLike, lift: ArrayLike, turn: ArrayLike = 0.0) -> Array:
    """Speed (...) m/s meant by a march of this cadence, thigh lift (0 to 1) and turn (rad/s).

    The step grows with the lift, fast at first: half of the longest at lift 0.3.
    """
    return _step_share(lift) * speed_limit(cadence, turn)


def march_lift(cadence: ArrayLike, speed: ArrayLike) -> Array:
    """Lift (...) at which a straight march of this cadence means this speed."""
    share = np.asarray(speed, dtype=np.float64) / np.maximum(speed_limit(cadence), 1e-9)
    return 1.0 - np.sqrt(1.0 - np.clip(share, 0.0, 1.0))


def max_turn(cadence: ArrayLike) -> Array:
    """Fastest turn (...) rad/s at a cadence (...) strides/s, in any gait."""
    return MAX_YAW_PER_STRIDE * np.asarray(cadence, dtype=np.float64)


def max_yaw_per_stride(tempo: ArrayLike) -> Array:
    """Most (...) rad that a stride may turn by."""
    return MAX_YAW_PER_STRIDE + (MAX_YAW_TROTTING - MAX_YAW_PER_STRIDE) * trot_share(tempo)


def within_reach(forward: float, left: float, longest: float, widest: float) -> tuple[float, float]:
    """A stride's way (m) in its own direction, no further than `longest` ahead, `widest` aside."""
    size = math.hypot(forward / max(longest, 1e-9), left / max(widest, 1e-9))
    return (forward, left) if size <= 1.0 else (forward / size, left / size)


def _step_share(lift: ArrayLike) -> Array:
    return 1.0 - (1.0 - np.clip(np.asarray(lift, dtype=np.float64), 0.0, 1.0)) ** 2


def swing_height(s: ArrayLike) -> Array:
    """Share (...) of its clearance a foot has at share s of its swing: up, along, down."""
    s = np.asarray(s, dtype=np.float64)
    return smoothstep(s / 0.4) * smoothstep((1.0 - s) / 0.4)


def clearance(lift: ArrayLike, cadence: ArrayLike) -> Array:
    """Height (...) m of a swinging sole; none at lift 0, where nothing is lifted.

    3 to 8 cm, growing like the step, fast at first: on soft legs a low foot scuffs. Trotting,
    4.5 to 6 cm: two legs carry and give way more, and joint speed is limited.
    """
    share = _step_share(lift)
    quick = smoothstep(np.asarray(cadence, dtype=np.float64) - 1.0)
    least, most = MIN_CLEARANCE + 0.015 * quick, MAX_CLEARANCE - 0.02 * quick
    return (least + (most - least) * share) * smoothstep(share / 0.2)


def sway(phase: ArrayLike, cadence: ArrayLike, tempo: ArrayLike) -> Array:
    """Offset (..., 2) m of the trunk along and to the left of its path.

    phase (...) in strides, cadence (...) in strides/s, tempo as `tempo` gives it.
    """
    phase, cadence = np.asarray(phase, dtype=np.float64), np.asarray(cadence, dtype=np.float64)
    turn = 2.0 * np.pi * (phase - _SWAY_CENTRE)
    lag = _HEIGHT_OVER_G * (2.0 * np.pi * cadence) ** 2
    side = np.cos(turn) / (1.0 + lag) + _THIRD * np.cos(3.0 * turn) / (1.0 + 9.0 * lag)
    along = np.sin(2.0 * (turn + 0.5 * np.pi)) / (1.0 + 4.0 * lag)
    still = 1.0 - trot_share(tempo)
    return np.stack([FORWARD + still * SWAY_X * along, still * SWAY_Y * side], axis=-1)


def slowest_cadence(speed: float, lift: float, turn: float = 0.0) -> float:
    """The slowest of MARCH_CADENCES at which a march of this lift reaches a speed (m/s) while it
    turns (rad/s); the quickest where none does."""
    for cadence in MARCH_CADENCES:
        if march_speed(cadence, lift, turn) >= speed:
            return cadence
    return MARCH_CADENCES[-1]
