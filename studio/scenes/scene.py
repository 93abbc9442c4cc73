"""A scene, declared: what stands around the robot, what there is to do, and when it is done.

Success is read off the simulated robot, the props and what touched what; never off a reference,
nor off the person.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from studio.robot.pose import RobotState
from studio.sim.props import PropShape

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Seen:
    """The world after one control period.

    pos: (3,) m, world, the centre of each prop. touched: (prop, what touched it) since the period
    before: a capsule of the robot ("FR_foot", "trunk_left" …) or another prop. dodged: the ball
    thrown last has flown by and met nothing of the robot.
    """

    robot: RobotState
    pos: Mapping[str, Array]
    touched: frozenset[tuple[str, str]]
    dodged: bool = False


@dataclass(frozen=True, kw_only=True)
class Throw:
    """A ball is thrown at the robot until it is dodged: it lies ahead, waits, and flies over.

    ball: a free prop. ahead: m before the trunk, where it lies. waits: (least, most) s until it
    flies. over: m, height of its centre where it passes over the trunk, at the top of its way: the
    less it falls there, the more a crouch is all that is needed. spread: (side, height) m by which
    throws differ, at most.
    """

    ball: str
    ahead: float = 1.5
    waits: tuple[float, float] = (2.0, 3.0)
    over: float = 0.345
    spread: tuple[float, float] = (0.04, 0.007)


@dataclass(frozen=True, kw_only=True)
class Step:
    """One thing to do. goal: said to whoever drives, of the robot; body: what they do for it
    themselves. hold: s for which `done` must stay true. within: s from the step before. throw: what
    is thrown meanwhile."""

    name: str
    goal: str
    body: str
    done: Callable[[Seen], bool]
    hold: float = 0.0
    within: float = 60.0
    throw: Throw | None = None


@dataclass(frozen=True, kw_only=True)
class Scene:
    """What stands around the robot, and what to do in which order; without steps there is no goal.

    name: as in options.SCENES. title, about: for people. start: (x m, y m, heading rad). avoid:
    props that cost points when the robot touches them. scatter: (x, y, z) m by which a prop's place
    differs from run to run, at most; the chance is the world's.
    """

    name: str
    title: str
    about: str
    props: tuple[PropShape, ...] = ()
    steps: tuple[Step, ...] = ()
    start: tuple[float, float, float] = (0.0, 0.0, 0.0)
    avoid: tuple[str, ...] = ()
    scatter: Mapping[str, tuple[float, float, float]] = field(default_factory=dict)

    @property
    def bodied(self) -> tuple[PropShape, ...]:
        """The props that have bodies of their own, and may be elsewhere than declared."""
        return tuple(prop for prop in self.props if prop.bodied)
