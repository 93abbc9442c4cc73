"""Walking with manual features instead of a network: cadence, step height and trunk of a person who
marches in place are read by rule as speed and turn, and the gait generator walks to them.

Only these two are taken from the person; the robot's steps are its own. The paper's alternative
for walking ("target velocities"), with the interface of a trained expert.
"""

import numpy as np
from numpy.typing import NDArray

from studio.human.features import FEATURE_DIM
from studio.reference.stepping import Stepper, forward_cadence
from studio.retarget.mapper import FrameByFrame, Mapped
from studio.retarget.march import MarchReader
from studio.retarget.striding import Striding
from studio.robot.a1 import CONTROL_DT


class SemanticWalk(FrameByFrame):
    """The walk expert of style "semantic": rules in place of weights, nothing to train."""

    remembers = True

    def begin(self) -> "SemanticStride":
        """Start anew on somebody's march."""
        return SemanticStride()


class SemanticStride:
    """One person's march in progress: reads them and walks on. One thread."""

    remembers = True

    def __init__(self) -> None:
        self.reader, self._stepper, self._striding = MarchReader(), Stepper("semantic"), Striding()

    def __call__(self, triplet: NDArray) -> Mapped:
        """One control period's triplet (3F,) to what an expert says of it."""
        march = self.reader.step(np.asarray(triplet[:FEATURE_DIM], np.float64))
        # Speed and turn as told, at a cadence of the robot's own.
        cadence = forward_cadence(march.speed) if march.speed > 0.0 else 0.0
        return self._striding.step(
            self._stepper.step(CONTROL_DT, cadence, march.speed, turn=march.turn)
        )
