"""Random marches: bouts of steps and pauses to phase, cadence, lift, speed and turn over time.

A bout begins and ends with all feet on the floor (gait.REST_PHASE) and covers a whole number of
half strides, as people do who march in place: the legs are at full tempo from the first step, while
the lift, and with it the speed, grows over the first step or two and falls over the last.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.geometry.time_scaling import smoothstep
from studio.reference import gait
from studio.reference.intent import IntentTrack
from studio.reference.tracks import frames_in, make_track
from studio.timing import CONTROL_HZ

Array = NDArray[np.float64]

_TEMPO_RAMP = 0.06  # strides: how soon the legs are at full tempo


@dataclass(frozen=True, kw_only=True)
class Bout:
    """Half strides at a cadence (1/s), with a lift, a turn (rad/s), then a pause (s).

    ramp: s over which lift, speed and turn come and go.
    """

    half_strides: int
    cadence: float
    lift: float
    turn: float = 0.0
    pause: float = 0.0
    ramp: float = 0.6


def march_track(
    task: str, seconds: float, bouts: list[Bout], *, lead: float = 0.3, crouch: float = 0.0
) -> IntentTrack:
    """The track (30 Hz) of these bouts after `lead` s of standing; stands when they are over."""
    length = frames_in(seconds)
    t = np.arange(length) / CONTROL_HZ
    phase = np.full(length, gait.REST_PHASE)
    cadence, lift, turn = np.zeros(length), np.zeros(length), np.zeros(length)
    begin = lead
    for bout in bouts:
        at_speed = 0.5 * bout.half_strides / bout.cadence
        start = _TEMPO_RAMP / bout.cadence
        end = begin + at_speed + start
        up, down = (t - begin) / start, (end - t) / start
        cadence += bout.cadence * smoothstep(np.minimum(up, down))
        # The integral of the cadence: exactly half_strides / 2 at the end.
        phase += bout.cadence * start * (_ramp_integral(up) - _ramp_integral(1.0 - down))
        ramp, bout_lift = _ramp(bout, at_speed)
        share = smoothstep(np.minimum(t - begin + 0.2 * ramp, end - t + 0.2 * ramp) / ramp)
        lift = np.maximum(lift, bout_lift * share)
        turn += bout.turn * share
        begin = end + bout.pause
    turn = np.clip(turn, -gait.max_turn(cadence), gait.max_turn(cadence))
    return make_track(
        "walk",
        task,
        length,
        phase=phase,
        cadence=cadence,
        lift=lift,
        turn=turn,
        speed=gait.march_speed(cadence, lift, turn),
        crouch=np.full(length, crouch),
    )


def _ramp(bout: Bout, at_speed: float) -> tuple[float, float]:
    """Time (s) for lift and speed to come and go, and the lift that a bout this short allows.

    As long as the way of a stride needs to grow (gait.WAY_GAIN), so that the robot's speed is the
    one that is meant: it does not start like a sprinter.
    """
    way = float(gait.march_speed(bout.cadence, bout.lift)) / bout.cadence
    needed = 1.2 * (way / gait.WAY_GAIN) / bout.cadence
    ramp = min(max(bout.ramp, needed), 0.5 * at_speed)
    return ramp, bout.lift * min(1.0, ramp / needed)


def _ramp_integral(x: Array) -> Array:
    """Integral of smoothstep from minus infinity to x: x^3 - x^4 / 2, then x - 1 / 2."""
    inside = np.clip(x, 0.0, 1.0)
    return inside**3 - 0.5 * inside**4 + np.maximum(x - 1.0, 0.0)
