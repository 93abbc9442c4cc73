"""A hand at the robot's trunk: a force for a moment, that a stop lets go of."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from studio.errors import StudioError
from studio.robot.a1 import CONTROL_DT
from studio.sim.world import World

Array = NDArray[np.float64]
MAX_FORCE = 60.0
"""N: half of the robot's weight."""
MAX_SECONDS = 1.0
"""s for which a force acts unless it is asked for again."""


class Pull:
    """The force that acts now. One thread; without one, the world is what it was, bit for bit."""

    def __init__(self) -> None:
        self.force = np.zeros(3)
        self._left, self._acts = 0.0, False

    def ask(self, force: ArrayLike, seconds: float) -> None:
        """From the next period on: (3,) N, world frame, at the trunk's middle, for so long; in
        place of what acted before. StudioError beyond the limits."""
        force = np.asarray(force, dtype=np.float64)
        if force.shape != (3,) or not np.linalg.norm(force) <= MAX_FORCE + 1e-9:
            raise StudioError(f"a push is three finite numbers, at most {MAX_FORCE:g} N long")
        if not 0.0 <= seconds <= MAX_SECONDS:
            raise StudioError(f"a push lasts at most {MAX_SECONDS:g} s: ask again meanwhile")
        self.force, self._left = force, seconds

    def let_go(self) -> None:
        """Nothing acts any more."""
        self.force, self._left = np.zeros(3), 0.0

    def step(self, world: World, damping: bool = False) -> None:
        """Before each control period of `world`. damping: a robot that is damped is let go of."""
        if damping or self._left <= 1e-9:
            self.let_go()
        if self._acts or self.force.any():
            world.data.xfrc_applied[world.model.body("trunk").id, :3] = self.force
            self._acts = bool(self.force.any())
        self._left -= CONTROL_DT
