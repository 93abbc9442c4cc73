"""Throws a ball over the robot, again and again until it is dodged; physics does the rest."""

import math

import numpy as np
from numpy.typing import NDArray

from studio import geometry
from studio.robot import a1
from studio.robot.a1 import CONTROL_DT
from studio.scenes.scene import Seen, Throw
from studio.sim.prop_world import PropWorld

Array = NDArray[np.float64]
_BY = 0.6
"""m behind the trunk: a ball that is so far has flown by."""
_GIVES_UP = 2.0
"""s after which a ball that hit, or lay still, is fetched for the next throw."""


class Thrower:
    """One step's throws. Chance is the world's. One thread."""

    def __init__(self, throw: Throw, world: PropWorld) -> None:
        self._throw, self._world = throw, world
        self.dodged = False
        self._fetch()

    def step(self, seen: Seen) -> int:
        """One control period; 1 in that in which the ball hits the robot, else 0."""
        self._t += CONTROL_DT
        if self._flies_at is not None and self._t >= self._flies_at:
            self._fly(seen)
        elif self._flies_at is None and not self.dodged:
            return self._watch(seen)
        return 0

    def _fetch(self) -> None:
        """Lay the ball before the robot."""
        world, throw = self._world, self._throw
        robot = world.state
        self._t, self._hit = 0.0, False
        self._flies_at: float | None = world.rng.uniform(*throw.waits)
        ahead = geometry.turn_xy(np.array([throw.ahead, 0.0]), robot.yaw)
        radius = world.props[throw.ball].size[0]
        world.throw(throw.ball, np.append(robot.base_pos[:2] + ahead, radius))

    def _fly(self, seen: Seen) -> None:
        """Kick it off so that the top of its way is over the trunk."""
        throw, rng = self._throw, self._world.rng
        side, high = rng.uniform(-1.0, 1.0, 2) * throw.spread
        start = seen.pos[throw.ball] + [0.0, 0.0, 0.01]  # clear of the floor, which would slow it
        way = seen.robot.base_pos[:2] - start[:2]
        self._way = way / np.linalg.norm(way)
        way = way + side * np.array([-self._way[1], self._way[0]])
        up = math.sqrt(2.0 * a1.GRAVITY * max(throw.over + high - start[2], 0.01))
        velocity = np.append(way * a1.GRAVITY / up, up)
        self._world.throw(throw.ball, start, velocity)
        self._flies_at, self._t = None, 0.0

    def _watch(self, seen: Seen) -> int:
        ball = self._throw.ball
        met = any(a == ball and b not in seen.pos for a, b in seen.touched)
        first, self._hit = met and not self._hit, self._hit or met
        behind = float((seen.pos[ball][:2] - seen.robot.base_pos[:2]) @ self._way)
        if not self._hit and behind > _BY:
            self.dodged = True
        elif self._t > _GIVES_UP:
            self._fetch()
        return int(first)
