"""The tour: one script of intents that visits every task of every state within 40 s."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from studio.geometry.time_scaling import smoothstep
from studio.reference import gait
from studio.reference.intent import StateName
from studio.synthetic import signals as sig
from studio.synthetic.filters import movement_kernel
from studio.synthetic.signals import DT

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Beat:
    """A stretch of the tour, of one library task.

    goal: fields of Intent, tilts in degrees. Standing and sitting rise to it, hold it for the share
    `hold` of the stretch, and are back at rest by its end; walking goes on from beat to beat.
    """

    state: StateName
    task: str
    seconds: float
    goal: dict[str, ArrayLike] = field(default_factory=dict)
    hold: float = 0.15


def _stand(seconds: float, task: str, **goal: ArrayLike) -> Beat:
    return Beat(state="stand", task=task, seconds=seconds, goal=goal)


def _walk(seconds: float, task: str, **goal: ArrayLike) -> Beat:
    return Beat(state="walk", task=task, seconds=seconds, goal=goal)


def _sit(seconds: float, task: str, **goal: ArrayLike) -> Beat:
    return Beat(state="sit", task=task, seconds=seconds, goal=goal)


TOUR: tuple[Beat, ...] = (
    _stand(0.8, "quiet"),
    _stand(1.2, "tilt", tilt=(0, 22, 0)),
    _stand(1.0, "tilt", tilt=(0, -16, 0)),
    _stand(1.0, "tilt", tilt=(18, 0, 0)),
    _stand(1.0, "tilt", tilt=(-18, 0, 0)),
    _stand(1.0, "tilt", tilt=(0, 0, 22)),
    _stand(1.0, "tilt", tilt=(0, 0, -22)),
    _stand(1.2, "crouch", crouch=1.0),
    _stand(2.3, "manipulate_right", reach=(0.9, 0.0)),
    _stand(2.3, "manipulate_left", reach=(0.0, 0.9)),
    _stand(2.3, "tilt_manipulate", reach=(0.7, 0.0), tilt=(0, -12, 12)),
    _stand(0.3, "quiet"),
    _walk(3.7, "walk", cadence=0.8, lift=0.5),
    _walk(2.6, "walk", cadence=1.4, lift=0.35),
    _walk(2.4, "turn", cadence=0.9, lift=0.4, turn=0.22),
    _walk(2.4, "turn", cadence=0.9, lift=0.4, turn=-0.22),
    _walk(1.8, "march", cadence=0.6, lift=0.9),
    _sit(4.0, "sit_quiet"),
    _sit(1.6, "sit_tilt", tilt=(0, 9, 0)),
    _sit(1.6, "sit_tilt", tilt=(5, -8, 0)),
    _sit(2.6, "sit_manipulate", reach=(0.8, 0.8)),
    _stand(1.6, "quiet"),
)
"""Where the robot changes state it takes one to three seconds, so each state is kept for longer."""

_PACE_S = 0.6  # s for a change of pace or direction while walking


def tour_signal() -> tuple[Array, list[str]]:
    """(T, NUM) signal at 30 Hz of the whole tour and, per frame, the task it shows."""
    rows, tasks = [], []
    walking = [beat for beat in TOUR if beat.state == "walk"]
    for beat in TOUR:
        if beat.state != "walk":
            rows.append(_held(beat))
        elif beat is walking[0]:
            rows.append(_walked(walking))
        tasks += [beat.task] * _frames(beat)
    return np.concatenate(rows), tasks


def _frames(beat: Beat) -> int:
    return round(beat.seconds / DT)


def _goal(beat: Beat) -> Array:
    goal = np.zeros(sig.NUM)
    goal[sig.TILT] = np.radians(np.asarray(beat.goal.get("tilt", (0, 0, 0)), dtype=float))
    goal[sig.REACH] = beat.goal.get("reach", (0.0, 0.0))
    for name, column in (("crouch", sig.CROUCH), ("turn", sig.TURN), ("lift", sig.LIFT)):
        goal[column] = beat.goal.get(name, 0.0)
    goal[sig.CADENCE] = beat.goal.get("cadence", 0.0)
    return goal


def _held(beat: Beat) -> Array:
    steps = _frames(beat)
    u = (np.arange(steps) + 1.0) / steps
    ramp = 0.5 * (1.0 - beat.hold)
    block = smoothstep(np.minimum(u, 1.0 - u) / ramp)[:, None] * _goal(beat)
    block[:, sig.SIT] = beat.state == "sit"
    return block


def _walked(beats: list[Beat]) -> Array:
    """One walk from standing to standing, changing pace on the way; it ends on whole steps."""
    goals = np.concatenate([np.tile(_goal(beat), (_frames(beat), 1)) for beat in beats])
    kernel = movement_kernel(_PACE_S, DT, "minimum_jerk")
    half = len(kernel) // 2
    rest = np.zeros((half, sig.NUM))

    def eased(rows: Array, before: Array, after: Array) -> Array:
        padded = np.concatenate([before, rows, after])
        smooth = [np.convolve(column, kernel, "same") for column in padded.T]
        return np.stack(smooth, axis=-1)[half:-half]

    # The legs are at full tempo from the first step to the last; lift and turn come and go.
    block = eased(goals, rest, rest)
    edges = np.repeat(goals[:1], half, axis=0), np.repeat(goals[-1:], half, axis=0)
    cadence = eased(goals, *edges)[:, sig.CADENCE]
    strides = np.sum(cadence) * DT
    cadence *= 0.5 * round(2.0 * strides) / strides
    turn = np.clip(block[:, sig.TURN], -gait.max_turn(cadence), gait.max_turn(cadence))
    block[:, sig.CADENCE], block[:, sig.TURN], block[:, sig.WALK] = cadence, turn, 1.0
    block[:, sig.PHASE] = gait.REST_PHASE + np.cumsum(cadence) * DT
    block[:, sig.SPEED] = gait.march_speed(cadence, block[:, sig.LIFT], turn)
    return block
