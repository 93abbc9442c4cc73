"""A take to episodes for learning: what was seen before an action, the action, what came of it.

A tick holds the robot as it was *after* its action (`puppeteer.step`). Whoever learns from pairs of
observation and action expects the observation first, so a step's observation is the robot of the
tick before. The person and the reference of a tick were there before its action.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio import geometry
from studio.errors import StudioError
from studio.robot import a1
from studio.takes.export.extent import extent
from studio.takes.take import Take

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Episode:
    """N steps without a gap, 1/30 s apart.

    tick: (N,) whose actions they are. before, after: the robot around each action, (N, …) by the
    names of RobotState. reference: (N, …) what was shown or retargeted. human: (N, 19, 3) m and
    confidence (N, 19), in step with the robot. action: (N, 12) PD targets, rad.
    """

    tick: NDArray[np.int64]
    before: dict[str, Array]
    after: dict[str, Array]
    reference: dict[str, Array]
    human: Array
    confidence: Array
    action: Array

    def __len__(self) -> int:
        return len(self.tick)

    def __getitem__(self, steps: slice | NDArray[np.int64]) -> "Episode":
        """Some of the steps."""
        groups = {
            key: {name: x[steps] for name, x in getattr(self, key).items()}
            for key in ("before", "after", "reference")
        }
        return Episode(
            tick=self.tick[steps],
            human=self.human[steps],
            confidence=self.confidence[steps],
            action=self.action[steps],
            **groups,
        )


def episodes(take: Take) -> list[Episode]:
    """One for each stretch that trim and cuts leave, and that no reset of the robot breaks.

    A take's first tick has no robot before its action, and no step. Raises StudioError when nothing
    is left.
    """
    part = extent(take)
    begun = _goes_on(take)[part.tick]
    tick = part.tick[begun]
    if not len(tick):
        raise StudioError(nothing_left(take))
    robot, reference = take.arrays.robot, take.arrays.reference
    whole = Episode(
        tick=tick,
        before={key: x[tick - 1] for key, x in robot.items()},
        after={key: x[tick] for key, x in robot.items()},
        reference={key: x[tick] for key, x in reference.items()},
        human=part.human[begun],
        confidence=part.confidence[begun],
        action=take.arrays.target[tick],
    )
    breaks = np.flatnonzero(np.diff(tick) != 1) + 1
    return [whole[rows] for rows in np.split(np.arange(len(tick)), breaks)]


def nothing_left(take: Take) -> str:
    """Why there is nothing to export."""
    if not len(take):
        return f"take {take.name} holds no tick that could be read: nothing is left to export"
    return f"nothing is left of take {take.name}: widen its trim, or undo its cuts"


def _goes_on(take: Take) -> NDArray[np.bool_]:
    """(T,) whether the tick's action began where the tick before had ended: no reset between."""
    t = np.array([tick.robot.t for tick in take.ticks])
    out = np.zeros(len(t), dtype=bool)
    out[1:] = np.abs(np.diff(t) - a1.CONTROL_DT) < 0.5 * a1.CONTROL_DT
    return out


def twist(robot: dict[str, Array]) -> Array:
    """(N, 6) the base's velocity m/s and rate rad/s, both in its own frame.

    robot: its base_quat (N, 4), base_lin_vel_w and base_ang_vel_b (N, 3).
    """
    linear = geometry.quat_rotate_inverse(robot["base_quat"], robot["base_lin_vel_w"])
    return np.concatenate([linear, robot["base_ang_vel_b"]], axis=1)


def words(take: Take) -> str:
    """What the take shows, in its own words: its label, else its note, else what was collected."""
    collected = ((take.meta.get("about") or {}).get("collect") or {}).get("task", "")
    said = take.label or (take.edits.note or "").partition("\n")[0] or collected
    return " ".join(said.replace("_", " ").split()) or "free motion"
