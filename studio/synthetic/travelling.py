"""The synthetic person crossing a room: a marcher whose floor moves, ahead, back, aside and around.

Their legs march whatever the way (a walk's own legs are not acted): of somebody who travels only
the way and the heading count (`retarget.travel`).
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from studio import geometry
from studio.human.pose import HumanPose
from studio.mocap.source import Source
from studio.reference.tasks_travel import draw_velocity
from studio.retarget.travel import robots_size
from studio.synthetic.operator import OperatorSource

Array = NDArray[np.float64]

STANDS_S = 1.5
"""s before they set off."""
CHANGE_S = 0.3
"""s, time constant of a change of speed."""
AT_PERSONS_SIZE = np.array([1.0, 1.0, robots_size(0.85)]) / robots_size(0.85)
"""(3,) times a robot's velocity (m/s, m/s, rad/s): that of a person with a leg of 0.85 m."""


class Travelling(Source):
    """Never ends; the same seed goes the same way. One thread only.

    velocity: (3,) m/s forward and to the left of the person, rad/s to the left, for good; None: one
    after another that the robot can follow (`tasks_travel.draw_velocity`), each for 2 to 6 s, a
    sixth of them a halt.
    """

    def __init__(
        self, seed: int = 0, velocity: Array | None = None, *, sensor: str = "mocap"
    ) -> None:
        self.name, self.starts_live, self.duration = "operator:travel", True, None
        self._source = OperatorSource("walk", seed=seed, sensor=sensor)
        self._rng = np.random.default_rng([seed, 13])
        self._given = velocity
        self._wanted, self._until = np.zeros(3), STANDS_S
        self._velocity, self._place, self._yaw, self._t = np.zeros(3), np.zeros(2), 0.0, 0.0

    def calibration_poses(self) -> list[HumanPose]:
        """Of the person where they start."""
        return self._source.calibration_poses()

    def close(self) -> None:
        """As the marcher's."""
        self._source.close()

    def read(self, t: float) -> HumanPose | None:
        """The newest pose, carried along."""
        pose = self._source.read(t)
        self._go(t - self._t, t)
        self._t = t
        if pose is None:
            return None
        turn = geometry.quat_from_yaw(self._yaw)
        joints = geometry.quat_rotate(turn, pose.joint_pos_w)
        joints[:, :2] += self._place
        return replace(pose, joint_pos_w=joints)

    def _go(self, dt: float, t: float) -> None:
        if t >= self._until:
            self._wanted = self._drawn() if self._given is None else np.asarray(self._given)
            self._until = t + self._rng.uniform(2.0, 6.0)
        self._velocity = self._velocity + min(dt / CHANGE_S, 1.0) * (self._wanted - self._velocity)
        forward, left, turn = self._velocity.tolist()
        self._yaw += turn * dt
        way = np.array([forward, left])
        self._place = self._place + dt * geometry.turn_xy(way, self._yaw)

    def _drawn(self) -> Array:
        if self._rng.random() < 1.0 / 6.0:
            return np.zeros(3)
        return draw_velocity(self._rng, 1.0) * AT_PERSONS_SIZE
