"""The tour: one script of intents that visits every task of every state within 40 s."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from studio.mocap.performer import signals as sig
from studio.mocap.performer.signals import DT
from studio.reference.intent import StateName
from studio.reference.marching import Bout, march_track

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Beat:
    """A stretch of the tour: it rises to `goal`, holds it, and is back at rest by its end.

    task: the library task it shows. goal: fields of Intent, tilts in degrees. hold: share of the
    stretch that the goal is kept. bout: the march of a walking beat, whose length it sets.
    """

    state: StateName
    task: str
    seconds: float = 0.0
    goal: dict[str, ArrayLike] = field(default_factory=dict)
    hold: float = 0.3
    bout: Bout | None = None


def _stand(seconds: float, task: str, **goal: ArrayLike) -> Beat:
    return Beat(state="stand", task=task, seconds=seconds, goal=goal)


def _walk(task: str, cadence: float, half_strides: int, **rest: float) -> Beat:
    bout = Bout(cadence=cadence, half_strides=half_strides, lift=rest.pop("lift", 0.45), **rest)
    seconds = 0.5 * half_strides / cadence + bout.ramp + bout.pause
    return Beat(state="walk", task=task, seconds=seconds, bout=bout)


def _sit(seconds: float, task: str, **goal: ArrayLike) -> Beat:
    return Beat(state="sit", task=task, seconds=seconds, goal=goal)


TOUR: tuple[Beat, ...] = (
    _stand(1.0, "quiet"),
    _stand(1.2, "tilt", tilt=(0, 25, 0)),
    _stand(1.0, "tilt", tilt=(0, -18, 0)),
    _stand(1.1, "tilt", tilt=(22, 0, 0)),
    _stand(1.1, "tilt", tilt=(-22, 0, 0)),
    _stand(1.1, "tilt", tilt=(0, 0, 28)),
    _stand(1.1, "tilt", tilt=(0, 0, -28)),
    _stand(1.4, "crouch", crouch=1.0),
    _stand(1.7, "manipulate_right", reach=(0.9, 0.0)),
    _stand(1.7, "manipulate_left", reach=(0.0, 0.9)),
    _stand(2.0, "tilt_manipulate", reach=(0.7, 0.0), tilt=(0, -12, 12)),
    _stand(0.4, "quiet"),
    _walk("walk", 0.8, 6),
    _walk("walk", 1.5, 9),
    _walk("march", 0.6, 2, lift=0.8, pause=0.3),
    _walk("turn", 0.9, 3, turn=0.24),
    _walk("turn", 0.9, 3, turn=-0.24),
    _sit(3.2, "sit_quiet"),
    _sit(1.3, "sit_tilt", tilt=(0, 13, 0)),
    _sit(1.3, "sit_tilt", tilt=(6, -8, 0)),
    _sit(2.6, "sit_manipulate", reach=(0.8, 0.8)),
    _stand(1.5, "quiet"),
)
"""Where the robot changes state it takes one to three seconds, so each state is kept for longer."""


def tour_signal() -> tuple[Array, list[str]]:
    """(T, NUM) signal at 30 Hz of the whole tour and, per frame, the task it shows."""
    rows, tasks = [], []
    for beat in TOUR:
        block = _march(beat.task, beat.bout) if beat.bout else _held(beat)
        rows.append(block)
        tasks += [beat.task] * len(block)
    return np.concatenate(rows), tasks


def _march(task: str, bout: Bout) -> Array:
    seconds = 0.5 * bout.half_strides / bout.cadence + bout.ramp + bout.pause
    return sig.of_track(march_track(task, seconds, [bout], lead=0.0))


def _held(beat: Beat) -> Array:
    steps = round(beat.seconds / DT)
    goal = np.zeros(sig.NUM)
    goal[sig.TILT] = np.radians(np.asarray(beat.goal.get("tilt", (0, 0, 0)), dtype=float))
    goal[sig.REACH] = beat.goal.get("reach", (0.0, 0.0))
    goal[sig.CROUCH] = beat.goal.get("crouch", 0.0)
    u = (np.arange(steps) + 1.0) / steps
    ramp = 0.5 * (1.0 - beat.hold)
    block = sig.smoothstep(np.minimum(u, 1.0 - u) / ramp)[:, None] * goal
    block[:, sig.WALK], block[:, sig.SIT] = beat.state == "walk", beat.state == "sit"
    return block
