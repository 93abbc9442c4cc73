"""What people do besides the library's tasks: brisk exercises and squats.

Library tasks move as fast as the robot may. People do not know that: they twist, bend, swing and
squat several times faster, and a selector or mapper must have seen it.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d, maximum_filter1d

from studio.geometry.time_scaling import smoothstep
from studio.reference.intent import IntentTrack
from studio.reference.tracks import frames_in, make_track
from studio.synthetic import signals as sig
from studio.synthetic.signals import DT

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Drill:
    """How somebody exercises: which movements, how far (shares of what the robot can), how long a
    repetition takes and from how long on it is done in full, and the longest rest between, s."""

    kinds: tuple[str, ...] = ("twist", "bend", "sides", "windmill", "raise", "wave", "knees")
    size: tuple[float, float] = (0.5, 1.0)
    down: float = 30.0  # degrees of a windmill
    linger: float = 0.0  # from 0, a sine, to 1: it stays a while at either end
    period: tuple[float, float] = (0.7, 4.0)
    full: float = 1.2
    rest: float = 0.8


USUAL = Drill()


def exercise(rng: np.random.Generator, seconds: float, drill: Drill = USUAL) -> IntentTrack:
    """A standing track (30 Hz) at people's pace: a few of twists, bends, windmills, knee bends …

    Each lasts some repetitions. The arms rise one at a time, as a stand allows.
    """
    length = frames_in(seconds)
    tilt, crouch = np.zeros((length, 3)), np.zeros(length)
    reach, side = np.zeros((length, 2)), np.zeros((length, 2))
    start = int(rng.uniform(0.2, 1.0) / DT)
    while start < length:
        period = float(np.exp(rng.uniform(*np.log(drill.period))))
        count = max(round(rng.uniform(2.0, 8.0) / period), 1)
        stop = min(start + round(count * period / DT), length)
        n = stop - start
        turn = 2.0 * np.pi * np.arange(n) * DT / period
        # Fades in and out within half a repetition.
        edge = smoothstep(2.0 * np.minimum(turn, turn[-1] - turn) / (2.0 * np.pi))
        size = rng.uniform(*drill.size) * min(1.0, period / drill.full)
        wave = _lingering(np.sin(turn), drill.linger) * edge * size
        once = 0.5 * (1.0 - _lingering(np.cos(turn), drill.linger)) * size
        span = slice(start, stop)
        kind = rng.choice(list(drill.kinds))
        if kind == "twist":
            tilt[span, 2] = np.radians(40.0) * wave
        elif kind == "bend":
            tilt[span, 1] = np.radians(rng.choice([40.0, 40.0, -25.0])) * once
        elif kind == "sides":
            tilt[span, 0] = np.radians(35.0) * wave
        elif kind == "windmill":
            down = np.radians(drill.down) * np.abs(wave)
            tilt[span] = np.stack([0.3 * wave, down, np.radians(40.0) * wave], axis=-1)
        elif kind == "lunge":  # down to one side, then to the other
            tilt[span, 0], crouch[span] = np.radians(25.0) * wave, np.abs(wave)
        elif kind in ("raise", "circle"):
            arm = int(rng.integers(2))
            reach[span, arm] = once
            # An arm that goes round comes down behind the way it went up.
            out = 0.5 - 0.5 * np.sin(turn) if kind == "circle" else rng.uniform(0.0, 1.0)
            side[span, arm] = (2 * arm - 1) * edge * out
        elif kind == "wave":
            arm = int(rng.integers(2))
            reach[span, arm] = edge * (rng.uniform(0.25, 0.8) + 0.08 * wave)
            side[span, arm] = (2 * arm - 1) * edge * (rng.uniform(-0.3, 1.0) + 0.2 * wave)
        else:
            crouch[span] = once
        start = stop + int(rng.uniform(0.0, drill.rest) / DT)
    return make_track(
        "stand", "exercise", length, tilt=tilt, crouch=crouch, reach=reach, reach_side=side
    )


def _lingering(wave: Array, share: float) -> Array:
    """(T,) of a sine in [-1, 1] whose ends are flattened."""
    return (1.0 - share) * wave + share * np.sin(0.5 * np.pi * wave)


def windmill_arms(track: IntentTrack, twists: bool = False) -> IntentTrack:
    """The same exercise by somebody whose arms are stretched out to both sides in its windmills.

    A hand that comes up because the trunk bends and twists is no reach: three feet cannot follow.
    twists: in every twist, bent or upright.
    """
    bent = smoothstep(np.abs(track.tilt[:, 2]) / 0.3)
    if not twists:
        bent = smoothstep(track.tilt[:, 1] / 0.2) * bent
    out = gaussian_filter1d(maximum_filter1d(bent, round(1.2 / DT)), 0.15 / DT)[:, None]
    return replace(
        track,
        reach=track.reach + out * (0.5 - track.reach),
        reach_side=track.reach_side + out * (np.array([-1.0, 1.0]) - track.reach_side),
    )


def squats(
    rng: np.random.Generator, seconds: float, hold: tuple[float, float] = (0.8, 4.0)
) -> Array:
    """(T, NUM) signal of somebody who sits down (or squats) and gets up again and again.

    Down for `hold` s, up for as long, with tilts and arms now and then on either level.
    """
    length = frames_in(seconds)
    signal = np.zeros((length, sig.NUM))
    frame, down = 0, bool(rng.integers(2))
    while frame < length:
        stop = min(frame + round(rng.uniform(*hold) / DT), length)
        n = stop - frame
        u = np.arange(n) / max(n - 1, 1)
        pulse = smoothstep(4.0 * np.minimum(u, 1.0 - u))
        signal[frame:stop, sig.SIT] = down
        if rng.random() < 0.4:
            limit = np.radians([7.0, 14.0, 3.0] if down else [15.0, 25.0, 20.0])
            signal[frame:stop, sig.TILT] = pulse[:, None] * rng.uniform(-1.0, 1.0, 3) * limit
        if rng.random() < 0.4:
            arms = rng.random(2) if down else np.eye(2)[rng.integers(2)]
            signal[frame:stop, sig.REACH] = pulse[:, None] * arms
        frame, down = stop, not down
    return signal
