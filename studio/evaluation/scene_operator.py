"""A scripted operator: somebody who sees the scene on the page and means what the next step needs.

They see robot and props from outside, a quarter of a second late and half a centimetre off,
and read which step is next. What they mean (an Intent) is acted out by the synthetic person; that
person's motion is all that reaches the robot.
"""

from collections import deque
from collections.abc import Callable, Generator, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from studio import geometry
from studio.reference.intent import Intent
from studio.robot.a1 import CONTROL_DT
from studio.scenes.stage import Stage

Array = NDArray[np.float64]
Meaning = Generator[Intent, None, None]

REACTION_S = 0.25
"""s from something on the page to the intent that answers it; acting it out takes its own time."""
ARM_RATE = 0.6
"""1/s, of `Intent.reach`: arms are raised and lowered slowly. An arm that is dropped at once from
overhead tips the sitting robot over backward."""
BLUR_M = 0.005
"""m, standard deviation of each coordinate that is seen, anew each period."""

_LOOKS_S = 1.0
"""s over which a turn is seen: a stride sways the trunk."""


@dataclass(frozen=True, kw_only=True)
class Sight:
    """What the page showed: step, the name of what is to be done; base (3,) m and yaw rad of the
    robot; turning: rad/s, over the last second; pos: (3,) m of each prop."""

    step: str
    base: Array
    yaw: float
    turning: float
    pos: Mapping[str, Array]

    def of(self, name: str) -> Array:
        """(2,) m, where a prop is from the robot: ahead, to the left."""
        return self.to(self.pos[name][:2])

    def to(self, xy: Array) -> Array:
        """(2,) m, where a place of the world is from the robot: ahead, to the left."""
        return geometry.turn_xy(np.asarray(xy) - self.base[:2], -self.yaw)


class Eyes:
    """The page, seen late. One thread."""

    def __init__(self, stage: Stage, rng: np.random.Generator) -> None:
        self._stage, self._rng = stage, rng
        self._shown: deque[Sight] = deque(maxlen=round(REACTION_S / CONTROL_DT) + 1)
        self._yaws: deque[float] = deque(maxlen=round(_LOOKS_S / CONTROL_DT) + 1)

    def see(self) -> Sight:
        """What was shown REACTION_S ago; the page shows what is now."""
        stage, robot = self._stage, self._stage.world.state
        step = stage.step_now
        self._yaws.append(robot.yaw)
        turned = float(geometry.wrap_angle(robot.yaw - self._yaws[0]))
        places = stage.seen.pos if stage.seen is not None else {}
        self._shown.append(
            Sight(
                step=step.name if step is not None else "",
                base=self._blurred(robot.base_pos),
                yaw=robot.yaw,
                turning=turned / _LOOKS_S,
                pos={name: self._blurred(pos) for name, pos in places.items()},
            )
        )
        return self._shown[0]

    def _blurred(self, pos: Array) -> Array:
        return pos + BLUR_M * self._rng.standard_normal(3)


class ScriptedOperator:
    """Means, period by period, what the step on the page needs. One thread."""

    def __init__(self, plays: Mapping[str, Callable[["ScriptedOperator"], Meaning]]) -> None:
        """plays: how each step of the scene is done, by its name."""
        self._plays = plays
        self._step: str | None = None
        self._meaning: Meaning | None = None
        self._reach = np.zeros(2)
        self.sight: Sight

    def mean(self, sight: Sight) -> Intent:
        """What is meant after having seen this."""
        self.sight = sight
        if sight.step != self._step:
            self._step = sight.step
            self._meaning = self._plays[sight.step](self) if sight.step else None
        meant = Intent() if self._meaning is None else next(self._meaning, Intent())
        most = ARM_RATE * CONTROL_DT
        self._reach = self._reach + np.clip(meant.reach - self._reach, -most, most)
        return replace(meant, reach=self._reach)
