"""Where each figure stands in the view: columns side by side, the world shifted to follow.

The camera stays and the scene moves, so that every page may hold its camera as it likes.
"""

import numpy as np
from numpy.typing import NDArray

from studio import geometry
from studio.human.pose import HumanPose
from studio.human.skeleton import INDEX

Array = NDArray[np.float64]

HUMAN_COLUMN = np.array([0.0, -0.86, 0.0])
REFERENCE_COLUMN = np.array([0.0, 0.0, 0.0])
ROBOT_COLUMN = np.array([0.0, 0.82, 0.0])
"""Origins of the three figures in the view, m: seen from the front, left to right."""
COLUMNS = {"human": HUMAN_COLUMN, "reference": REFERENCE_COLUMN, "robot": ROBOT_COLUMN}
WIDE_COLUMNS = {
    "human": np.array([0.0, -1.35, 0.0]),
    "reference": np.array([0.0, -0.6, 0.0]),
    "robot": np.array([0.0, 0.9, 0.0]),
}
"""The same beside props, which need a lane of their own around the robot."""
HUMAN_SCALE = 0.56
"""The person is drawn smaller: beside a robot 0.3 m high, at full size they fill the view."""
SOLE = 0.035
"""The toe and ankle joints are this far above the sole, m (before scaling)."""


HALF_TURN = np.array([0.0, 0.0, 0.0, 1.0])
"""(4,) wxyz, about z."""


def faced_away(points: Array, column: Array) -> Array:
    """Points (..., 3) m of a figure, turned by half a turn about the vertical of its column."""
    return points * (-1.0, -1.0, 1.0) + 2.0 * column * (1.0, 1.0, 0.0)


JUMP = 4.0
"""m: further, nothing is seen."""


class Follow:
    """Smoothed ground position of a figure; (x, y) to be taken away from it."""

    def __init__(self, time_constant: float = 0.25) -> None:
        self.time_constant = time_constant
        self.reset()

    def reset(self) -> None:
        """The next position is taken as it is."""
        self._xy: Array | None = None

    def push(self, xy: Array, dt: float) -> Array:
        """(2,) m to subtract; a jump further than a page shows is followed at once, so that
        a robot that is set down near by is seen there first."""
        before = self._xy
        if before is None or np.linalg.norm(xy - before) > JUMP:
            before = np.array(xy, dtype=np.float64)
        after = before + (1.0 - np.exp(-dt / self.time_constant)) * (xy - before)
        self._xy = after
        return after


class Above:
    """Smoothed height of a caption over a figure's highest point, m; never under `low`.

    It moves when the figure would reach into it, and comes down when the figure is lower by more
    than `slack`: in a quiet motion it stays where it is.
    """

    def __init__(
        self,
        low: float,
        gap: float,
        *,
        first: float | None = None,
        slack: float = 0.0,
        time_constant: float = 0.3,
    ) -> None:
        """first: the height to begin with, if not `low`."""
        self.low, self.gap, self.slack, self.time_constant = low, gap, slack, time_constant
        self.height = self._wanted = low if first is None else first

    def push(self, top: float, dt: float) -> float:
        """The height for a figure that reaches up to `top` m."""
        wanted = max(self.low, top + self.gap)
        if not self._wanted - self.slack <= wanted <= self._wanted:
            self._wanted = wanted
        self.height += (1.0 - np.exp(-dt / self.time_constant)) * (self._wanted - self.height)
        return self.height


class HumanPlace:
    """Puts the person of any source on the view's floor, facing the camera, at their column."""

    def __init__(self) -> None:
        self._follow = Follow(0.5)
        self.reset()

    def reset(self) -> None:
        """Forget floor and heading: another source."""
        self._follow.reset()
        self._floor: float | None = None
        self._facing: Array | None = None

    def place(self, pose: HumanPose, dt: float) -> Array:
        """(19, 3) m in the view: a turn about z, a shift and HUMAN_SCALE of the pose's joints.

        The heading follows the hips slowly (3 s), so that a twist shows and a turn is forgotten;
        the floor is the lowest foot seen lately, so that a jump shows.
        """
        joints = pose.joint_pos_w
        left = joints[INDEX["l_hip"]] - joints[INDEX["r_hip"]]
        facing = geometry.normalize(np.array([left[1], -left[0]]))
        if self._facing is None or facing @ self._facing < -0.5:
            self._facing = facing
        self._facing = geometry.normalize(
            self._facing + (1.0 - np.exp(-dt / 3.0)) * (facing - self._facing)
        )
        lowest = float(joints[:, 2].min())
        if self._floor is None or abs(lowest - self._floor) > 1.0:
            self._floor = lowest
        self._floor = min(lowest, self._floor + 0.05 * dt)
        c, s = self._facing
        turn = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
        xy = self._follow.push(joints[INDEX["pelvis"], :2], dt)
        shifted = joints - np.array([xy[0], xy[1], self._floor - SOLE])
        return HUMAN_SCALE * shifted @ turn.T + HUMAN_COLUMN
