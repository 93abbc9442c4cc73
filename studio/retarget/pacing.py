"""Walking at the speed and turn that a network says, in steps of the gait generator.

A network says each frame by itself, an average over people who step unlike: its strides are
uneven, its feet and its speed not quite of one mind, and what tracks them falls on slopes
(models/policy/README.md). So it says how fast and which way, and the generator makes the steps, in
time with the person's where they march.
"""

import math

import numpy as np
from numpy.typing import NDArray

from studio.geometry import scalars
from studio.human.features import FEATURE_DIM
from studio.reference import gait
from studio.reference.stepping import Stepper, forward_cadence
from studio.reference.tasks_walk import MAX_TURN
from studio.retarget.experts import WALK
from studio.retarget.mapper import RATES, Expert, FrameByFrame, Mapped
from studio.retarget.march import March, MarchReader
from studio.retarget.striding import Striding
from studio.robot.a1 import CONTROL_DT

Array = NDArray[np.float64]

SPEED_TAU = 0.25
"""s, low-pass of the network's speed: within a step it swings."""
TURN_TAU = 0.8
"""s, of its turn: a march sways the trunk at every step."""
TURN_DEAD_ZONE = math.radians(4.0)
"""rad/s: slower turns are nobody's wish (without this a real march, trunk a few degrees to the
left, veered by 46 degrees in 9 s)."""
GO, HALT = 0.06, 0.03
"""m/s that the network says, at which steps begin and at which they are over."""
NEARLY = 0.75
"""Share of the speed that the person's own cadence has to reach for the robot to step in time."""
IN_STEP = 0.4
"""Share by which the robot's steps are quicker for each stride that it is behind the person's."""


class Turning:
    """The turn that is meant: a network's, over some strides, without what is nobody's wish."""

    def __init__(self) -> None:
        self._felt = 0.0

    def step(self, base_quat: Array, rates: Array, dt: float = CONTROL_DT) -> float:
        """rad/s, > 0 left, at most MAX_TURN, of a trunk (4,) wxyz and its rates (36,)."""
        ang_vel = WALK.turn_gain * rates[RATES["base_ang_vel"]]
        rate = float(scalars.matrix(base_quat.tolist())[2] @ ang_vel)
        self._felt += (rate - self._felt) * min(1.0, dt / TURN_TAU)
        beyond = min(abs(self._felt), MAX_TURN) - TURN_DEAD_ZONE
        gain = MAX_TURN / (MAX_TURN - TURN_DEAD_ZONE)
        return math.copysign(max(0.0, beyond) * gain, self._felt)


class PacedWalk(FrameByFrame):
    """A walk expert of a network and the generator. speed_gain: times the network's speed."""

    remembers = True

    def __init__(self, network: Expert, speed_gain: float = 1.0) -> None:
        self._network, self._speed_gain = network, speed_gain

    def begin(self) -> "PacedStride":
        """Start anew, from standing, on somebody's march."""
        return PacedStride(self._network, self._speed_gain)


class PacedStride:
    """One person's walk in progress. One thread."""

    def __init__(self, network: Expert, speed_gain: float) -> None:
        self._map, self._speed_gain = network.begin(), speed_gain
        self._march, self._turning = MarchReader(), Turning()
        self._stepper, self._striding = Stepper("march"), Striding()
        self._speed, self._goes = 0.0, False

    def __call__(self, triplet: NDArray) -> Mapped:
        """One control period's triplet (3F,) to what an expert says of it."""
        said = self._map(triplet)
        march = self._march.step(np.asarray(triplet[:FEATURE_DIM], np.float64))
        told = self._speed_gain * float(said.rates[RATES["base_lin_vel"]][0])
        self._speed += (told - self._speed) * CONTROL_DT / (SPEED_TAU + CONTROL_DT)
        turn = self._turning.step(said.base_quat, said.rates)
        self._goes = self._speed > (HALT if self._goes else GO)
        if not self._goes:
            return self._striding.step(self._stepper.step(CONTROL_DT, 0.0, 0.0))
        cadence, speed = self._paced(min(self._speed, gait.MAX_SPEED), march)
        return self._striding.step(self._stepper.step(CONTROL_DT, cadence, speed, turn=turn))

    def _paced(self, speed: float, march: March) -> tuple[float, float]:
        """Strides/s and m/s: in step with the person, if their cadence nearly has the speed."""
        reached = float(gait.speed_limit(march.cadence)) if march.cadence > 0.0 else 0.0
        if reached < NEARLY * speed:
            return forward_cadence(speed), speed
        quicker = 1.0 + IN_STEP * self._stepper.behind(march.phase)
        return march.cadence * quicker, min(speed, reached)
