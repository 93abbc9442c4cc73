"""A scripted operator: somebody who sees the scene on the page and means what the next step needs.

They see robot and props from outside, a quarter of a second late and half a centimetre off,
and read which step is next; who is not in the room sees less (`scene_views`). What they mean (an
Intent) is acted out by the synthetic person; that person's motion is all that reaches the robot.
"""

from collections import deque
from collections.abc import Callable, Generator, Mapping
from dataclasses import dataclass, field, replace

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

LOOKS_ROUND = Intent(state="walk", task="walk", cadence=0.5, lift=0.3, turn=0.45)
WALKS_ON = Intent(state="walk", task="walk", cadence=0.75, lift=0.5)
"""Whoever does not see what they need turns slowly, to the left here, until they do, and walks on
after a turn in vain; first, where it is too near to be seen."""
TURN_S, ON_S, TOO_NEAR = 25.0, 5.0, 1.0
"""s of a turn, s of walking on, m."""

STARTS_S = 2.0
"""s of a march until the robot walks. A trunk that is twisted before turns the standing robot, and
back as it goes; a few fell over it. So turn first when it walks."""
STALLED_S, STALLED_M, STALLED_RAD_S = 4.0, 0.02, 0.05
"""s of a march after which a robot that moves and turns by less in a second has stopped."""

_LOOKS_S = 1.0
"""s over which a turn is seen: a stride sways the trunk."""


@dataclass(frozen=True, kw_only=True)
class Sight:
    """What the page showed: step, the name of what is to be done; base (3,) m and yaw rad of the
    robot; turning: rad/s, over the last second; pos: (3,) m of each prop.

    Through the robot's camera all this is what the operator takes it to be: `pos` what is seen or
    remembered; lost: of what was not found where it should be, (2,) m, where that was from the
    robot: ahead, to the left. places: (2,) m of what lies fast, for who sees it from outside.
    """

    step: str
    base: Array
    yaw: float
    turning: float
    pos: Mapping[str, Array]
    places: Mapping[str, Array] = field(default_factory=dict)
    lost: Mapping[str, Array] = field(default_factory=dict)

    def spot(self, name: str) -> Array:
        """(2,) m, world: where a mark, or what else lies fast, is."""
        return self.places[name] if name in self.places else self.pos[name][:2]

    def of(self, name: str) -> Array:
        """(2,) m, where a prop is from the robot: ahead, to the left."""
        return self.to(self.pos[name][:2])

    def to(self, xy: Array) -> Array:
        """(2,) m, where a place of the world is from the robot: ahead, to the left."""
        return geometry.turn_xy(np.asarray(xy) - self.base[:2], -self.yaw)


class Eyes:
    """The page, seen late: robot and props from outside. One thread."""

    def __init__(self, stage: Stage, rng: np.random.Generator) -> None:
        self._stage, self._rng = stage, rng
        self._shown: deque[Sight] = deque(maxlen=round(REACTION_S / CONTROL_DT) + 1)
        self._yaws: deque[float] = deque(maxlen=round(_LOOKS_S / CONTROL_DT) + 1)
        scene = stage.scene
        self._places = {
            prop.name: np.array(prop.pos[:2])
            for prop in scene.props
            if prop.held in ("drawn", "fixed") and prop.name not in scene.scatter
        }

    def see(self, meant: Intent) -> Sight:
        """What was shown REACTION_S ago; the page shows what is now. meant: by its operator, in
        the period before."""
        step = self._stage.step_now
        self._shown.append(self._look(step.name if step is not None else "", meant))
        return self._shown[0]

    def doubt(self, name: str) -> bool:
        """All that was tried at a prop came to nothing: whether its place was believed, not seen,
        and is now to be looked for."""
        return False

    def _look(self, step: str, meant: Intent) -> Sight:
        robot, seen = self._stage.world.state, self._stage.seen
        base = self._blurred(robot.base_pos)
        places = seen.pos if seen is not None else {}
        return Sight(
            step=step,
            base=base,
            yaw=robot.yaw,
            turning=self._turning(robot.yaw),
            pos={name: self._blurred(pos) for name, pos in places.items()},
            places=self._places,
        )

    def _turning(self, yaw: float) -> float:
        """rad/s over the last second, of a heading (rad) that is told each period."""
        self._yaws.append(yaw)
        return float(geometry.wrap_angle(yaw - self._yaws[0])) / _LOOKS_S

    def _blurred(self, pos: Array) -> Array:
        return pos + BLUR_M * self._rng.standard_normal(3)


class ScriptedOperator:
    """Means, period by period, what the step on the page needs. One thread."""

    def __init__(
        self,
        plays: Mapping[str, Callable[["ScriptedOperator"], Meaning]],
        doubt: Callable[[str], bool] = lambda name: False,
    ) -> None:
        """plays: how each step of the scene is done, by its name. doubt: as `Eyes.doubt`."""
        self._plays, self.doubt = plays, doubt
        self._step: str | None = None
        self._meaning: Meaning | None = None
        self._reach = np.zeros(2)
        self.meant = Intent()
        self._looking: float | None = None
        self._marched, self._straight = 0.0, 0.0
        self._bases: deque[Array] = deque(maxlen=round(_LOOKS_S / CONTROL_DT) + 1)
        self.sight: Sight

    def mean(self, sight: Sight) -> Intent:
        """What is meant after having seen this."""
        self.sight = sight
        if sight.step != self._step:
            self._step = sight.step
            self._meaning = self._plays[sight.step](self) if sight.step else None
        meant = Intent() if self._meaning is None else self._next(self._meaning, sight)
        meant = self._untwisted(meant)
        most = ARM_RATE * CONTROL_DT
        self._reach = self._reach + np.clip(meant.reach - self._reach, -most, most)
        self.meant = replace(meant, reach=self._reach)
        return self.meant

    def _next(self, meaning: Meaning, sight: Sight) -> Intent:
        """What the step needs; or, where the operator does not know where its things are, a look
        round for them."""
        play = self._plays[sight.step]
        for name in needs(play):
            if name not in sight.pos:
                return self._look_for(sight.lost[name])
        self._looking = None
        intent = next(meaning, None)
        if intent is None and any([self.doubt(name) for name in needs(play)]):
            self._meaning = play(self)
        return intent or Intent()

    def _untwisted(self, meant: Intent) -> Intent:
        """Whoever sees the robot stop though they march, for a twist can look like standing, first
        marches straight on until it walks again."""
        self._bases.append(self.sight.base[:2])
        self._marched = self._marched + CONTROL_DT if meant.state == "walk" else 0.0
        way = float(np.linalg.norm(self._bases[-1] - self._bases[0]))
        if (
            self._marched > STALLED_S
            and way < STALLED_M
            and abs(self.sight.turning) < STALLED_RAD_S
        ):
            self._marched, self._straight = 0.0, STARTS_S
        self._straight -= CONTROL_DT
        return replace(meant, turn=0.0) if self._straight > 0.0 else meant

    def _look_for(self, where: Array) -> Intent:
        """The next period of looking for something that should have been there, (2,) m."""
        if self._looking is None:
            self._looking = TURN_S if np.hypot(*where) < TOO_NEAR else 0.0
        self._looking += CONTROL_DT
        if self._looking % (TURN_S + ON_S) > TURN_S:
            return WALKS_ON
        return replace(LOOKS_ROUND, turn=float(np.copysign(LOOKS_ROUND.turn, where[1])))


def needs(play: Callable[..., Meaning]) -> tuple[str, ...]:
    """The props that a play is about: the names that it was given."""
    given = getattr(play, "keywords", {}).values()
    return tuple(each for each in given if isinstance(each, str))
