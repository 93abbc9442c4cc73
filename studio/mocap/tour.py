"""The tour: one script of intents that visits every task of every state within 40 s."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from studio.mocap.performer import signals as sig
from studio.mocap.performer.signals import DT
from studio.reference.intent import StateName

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Beat:
    """A stretch of the tour: by its end everything in `goal` is reached, all else is at rest.

    goal: fields of Intent, tilts in degrees. hold: share of the stretch that the goal is kept.
    task: the library task it shows.
    """

    seconds: float
    state: StateName
    task: str
    goal: dict[str, object] = field(default_factory=dict)
    hold: float = 0.3


def _stand(seconds: float, task: str, **goal: object) -> Beat:
    return Beat(seconds=seconds, state="stand", task=task, goal=goal)


def _walk(seconds: float, task: str, speed: float, cadence: float, turn: float = 0.0) -> Beat:
    goal = {"speed": speed, "cadence": cadence, "turn": turn, "lift": 0.45}
    return Beat(seconds=seconds, state="walk", task=task, goal=goal, hold=0.85)


def _sit(seconds: float, task: str, **goal: object) -> Beat:
    return Beat(seconds=seconds, state="sit", task=task, goal=goal)


TOUR: tuple[Beat, ...] = (
    _stand(1.2, "quiet"),
    _stand(1.2, "tilt", tilt=(0, 25, 0)),
    _stand(1.0, "tilt", tilt=(0, -18, 0)),
    _stand(1.1, "tilt", tilt=(22, 0, 0)),
    _stand(1.1, "tilt", tilt=(-22, 0, 0)),
    _stand(1.1, "tilt", tilt=(0, 0, 28)),
    _stand(1.1, "tilt", tilt=(0, 0, -28)),
    _stand(1.4, "crouch", crouch=1.0),
    _stand(1.7, "manipulate", reach=(0.9, 0.0)),
    _stand(1.7, "manipulate", reach=(0.0, 0.9)),
    _stand(2.0, "tilt_manipulate", reach=(0.7, 0.0), tilt=(0, -12, 12)),
    _stand(0.6, "quiet"),
    _walk(4.2, "walk", 0.4, 0.8),
    _walk(3.0, "walk", 0.8, 1.3),
    _walk(2.4, "turn", 0.4, 0.9, 0.24),
    _walk(2.4, "turn", 0.4, 0.9, -0.24),
    _stand(1.2, "quiet"),
    _sit(4.0, "quiet"),
    _sit(1.3, "sit_tilt", tilt=(0, 13, 0)),
    _sit(1.3, "sit_tilt", tilt=(6, -8, 0)),
    _sit(2.6, "sit_manipulate", reach=(0.8, 0.8)),
    _stand(1.6, "quiet"),
)
TOUR_SECONDS = sum(beat.seconds for beat in TOUR)


def tour_signal() -> tuple[Array, list[str]]:
    """(T, NUM) signal at 30 Hz of the whole tour and, per frame, the task it shows.

    A beat rises to its goal, holds it, and the next beat starts from there; a walk that follows
    a walk changes pace without stopping.
    """
    rows, tasks, level = [], [], np.zeros(sig.NUM)
    for i, beat in enumerate(TOUR):
        steps = round(beat.seconds / DT)
        goal = _row(beat)
        after = TOUR[(i + 1) % len(TOUR)]
        rest = _row(Beat(seconds=0.0, state=after.state, task=after.task))
        linked = beat.state == "walk" == after.state
        u = (np.arange(steps) + 1.0) / steps
        ramp = 0.5 * (1.0 - beat.hold) if not linked else 1.0 - beat.hold
        up = sig.smoothstep(u / ramp)[:, None]
        down = sig.smoothstep((u - (1.0 - ramp)) / ramp)[:, None] * (not linked)
        block = level + up * (goal - level)
        block = block + down * (rest - block)
        block[:, [sig.WALK, sig.SIT]] = goal[[sig.WALK, sig.SIT]]
        rows.append(block)
        tasks += [beat.task] * steps
        level = block[-1].copy()
    signal = np.concatenate(rows)
    signal[:, sig.PHASE] = np.cumsum(signal[:, sig.CADENCE]) * DT
    return signal, tasks


def _row(beat: Beat) -> Array:
    row = np.zeros(sig.NUM)
    goal = beat.goal
    row[sig.TILT] = np.radians(np.asarray(goal.get("tilt", (0, 0, 0)), dtype=float))
    row[sig.REACH] = goal.get("reach", (0.0, 0.0))
    row[sig.CROUCH] = goal.get("crouch", 0.0)
    row[sig.SPEED], row[sig.TURN] = goal.get("speed", 0.0), goal.get("turn", 0.0)
    row[sig.CADENCE], row[sig.LIFT] = goal.get("cadence", 0.0), goal.get("lift", 0.0)
    row[sig.WALK], row[sig.SIT] = beat.state == "walk", beat.state == "sit"
    return row
