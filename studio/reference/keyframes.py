"""Random goals to motion: key intents one to three seconds apart, joined by minimum-jerk curves.

Each segment is given the time its joints need: a goal too far for the speed limit takes longer, up
to three seconds, and beyond that is brought nearer.
"""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from studio.geometry.time_scaling import minimum_jerk
from studio.reference.intent import IntentTrack, StateName
from studio.reference.realize import realize
from studio.reference.stances import JOINT_SPEED
from studio.reference.tracks import frames_in, make_track
from studio.timing import CONTROL_HZ

Array = NDArray[np.float64]

MIN_SECONDS, MAX_SECONDS = 1.0, 3.0
"""s: time between key poses (the paper)."""
_MARGIN = 0.95


@dataclass(frozen=True, kw_only=True)
class Goal:
    """A key pose as an intent: tilt (3,) rad, crouch, reach (2,), reach_side (2,)."""

    tilt: Array = field(default_factory=lambda: np.zeros(3))
    crouch: float = 0.0
    reach: Array = field(default_factory=lambda: np.zeros(2))
    reach_side: Array = field(default_factory=lambda: np.zeros(2))

    def vector(self) -> Array:
        """(8,) tilt, crouch, reach, reach_side."""
        return np.concatenate([self.tilt, [self.crouch], self.reach, self.reach_side])


def keyframe_track(
    rng: np.random.Generator,
    state: StateName,
    task: str,
    seconds: float,
    draw: Callable[[np.random.Generator], Goal],
    hold: tuple[float, float] = (0.0, 1.0),
) -> IntentTrack:
    """A track (30 Hz) from the neutral pose through random goals, resting `hold` s at each."""
    count = int(seconds / MIN_SECONDS) + 2
    goals = np.stack([np.zeros(8), *(draw(rng).vector() for _ in range(count))])
    moves = rng.uniform(MIN_SECONDS, MAX_SECONDS, count)
    rests = rng.uniform(*hold, count)
    for _ in range(8):
        track = interpolate(state, task, seconds, goals, moves, rests)
        excess = _speed_excess(track, moves, rests)
        if np.all(excess <= 1.0):
            break
        wanted = moves * excess
        for k in np.flatnonzero(wanted > MAX_SECONDS):
            goals[k + 1] = goals[k] + (goals[k + 1] - goals[k]) * MAX_SECONDS / wanted[k]
        moves = np.minimum(wanted, MAX_SECONDS)
    return track


def interpolate(
    state: StateName, task: str, seconds: float, goals: Array, moves: Array, rests: Array
) -> IntentTrack:
    """The track through goals (K + 1, 8): rests[k] s at goal k, then moves[k] s to the next."""
    length = frames_in(seconds)
    start = np.concatenate([[0.0], np.cumsum(rests + moves)[:-1]]) + rests
    t = np.arange(length) / CONTROL_HZ
    k = np.clip(np.searchsorted(start, t, side="right") - 1, 0, len(moves) - 1)
    s = minimum_jerk((t - start[k]) / moves[k])[:, None]
    value = goals[k] + s * (goals[k + 1] - goals[k])
    return make_track(
        state,
        task,
        length,
        tilt=value[:, :3],
        crouch=value[:, 3],
        reach=value[:, 4:6],
        reach_side=value[:, 6:8],
    )


def _speed_excess(track: IntentTrack, moves: Array, rests: Array) -> Array:
    """Per segment (K,): the largest joint speed over the limit (with a margin), at least 1."""
    start = np.concatenate([[0.0], np.cumsum(rests + moves)[:-1]]) + rests
    motion = realize(track)
    peak = np.max(np.abs(motion.joint_vel), axis=-1) / (_MARGIN * JOINT_SPEED[motion.state])
    t = np.arange(len(track)) * track.dt
    excess = np.ones(len(moves))
    for k in range(len(moves)):
        inside = (t > start[k]) & (t <= start[k] + moves[k] + track.dt)
        if np.any(inside):
            excess[k] = max(1.0, float(np.max(peak[inside])))
    return excess
