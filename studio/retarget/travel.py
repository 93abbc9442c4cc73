"""Walking through space: where a person goes, the robot goes beside them, at its own size.

    way   = sqrt(robot's leg / person's leg) * the pelvis' way     (equal Froude numbers)
    turn  = the turn of the lower body

A march in place says nothing of a direction; somebody who crosses the room does. Of them only the
way and the heading are taken: the steps are the robot's own (`reference.stepping`), on the floor of
its own reference, so that it neither drifts away from the person's path nor excites its gait. Who
has not travelled yet is read as before (a treadmill and a webcam never are).
"""

import math
from collections import deque

import numpy as np
from numpy.typing import NDArray

from studio import geometry
from studio.human.features import FEATURE_DIM
from studio.human.pose import HumanPose
from studio.human.posture import SEEN, body_heading, wrapped
from studio.human.skeleton import INDEX
from studio.reference import gait
from studio.reference.stepping import Stepper, trot_cadence
from studio.reference.tasks_travel import MAX_SPIN
from studio.retarget.mapper import FrameByFrame, Mapped
from studio.retarget.march import MarchReader
from studio.retarget.striding import Striding
from studio.robot import a1
from studio.robot.a1 import CONTROL_DT

Array = NDArray[np.float64]

FOUND_S, FOUND_M = 1.0, 0.35
"""s and m: a pelvis that comes this far in this time travels; nobody sways so."""
GO, HALT = 0.15, 0.07
"""m/s of the person at which a step is under way, and at which it is over."""
SMOOTH_S = 0.2
"""s, low-pass of the person's speed and turn: within a step the pelvis speeds up and slows down."""
CATCH_UP_S = 1.0
"""s in which the robot's reference makes up for what it lags behind."""
FACE_S = 0.35
"""s in which it turns to where the person faces."""
MAX_LAG = 0.3
"""m (of the robot) that it makes up for at most: who runs faster than it can is let go."""
_FASTEST = 4.0
"""m/s of a person that are believed."""


def robots_size(leg_length: float) -> float:
    """Ways and speeds of the robot over those of a person with legs of so many m (Froude)."""
    return math.sqrt(a1.STAND_HEIGHT / max(leg_length, 0.2))


class PathReader:
    """Where a person is and how they move, seen pose by pose at 30 Hz; one thread.

    mirror: left for right. pos: (2,) m at the robot's size, in the source's world. heading: rad,
    unwrapped; turn: rad/s, low-passed. found: they have travelled; moving: they do so now.
    """

    def __init__(self) -> None:
        self.mirror = False
        self.reset()

    def reset(self) -> None:
        """Nobody was seen yet."""
        self.pos, self._size = np.zeros(2), 1.0
        self.heading = self.turn = 0.0
        self.found = self.moving = False
        self._seen: tuple[float, Array, float] | None = None
        self._recent: deque[tuple[float, Array]] = deque()
        self._speed = np.zeros(2)  # of the person, m/s

    def see(self, pose: HumanPose | None, leg_length: float) -> None:
        """One control period. leg_length: m, the person's. None: nobody new was seen; who moved
        goes on ever slower."""
        if pose is None or pose.confidence[INDEX["pelvis"]] < SEEN:
            self._toward(np.zeros(2), 0.0)
            return
        place = np.array(pose.joint_pos_w[INDEX["pelvis"], :2])
        facing, weight = body_heading(pose.joint_pos_w, pose.confidence)
        if self.mirror:
            place, facing = place * [1.0, -1.0], -facing
        last, self._seen = self._seen, (pose.t, place, facing)
        if last is None:
            self.heading = facing
            return
        dt = pose.t - last[0]
        if dt <= 0.0:  # the same pose again
            return
        way, turned = place - last[1], wrapped(facing - last[2]) if weight > 0.05 else 0.0
        if np.hypot(*way) > _FASTEST * max(dt, CONTROL_DT):  # taken for somebody else
            way, turned = np.zeros(2), 0.0
            self._recent.clear()
        self._size = robots_size(leg_length)
        self.pos = self.pos + self._size * way
        self.heading += turned
        self._toward(way / dt, turned / dt)
        self._find(pose.t, place)

    @property
    def vel(self) -> Array:
        """(2,) m/s at the robot's size, low-passed, in the source's world."""
        return self._size * self._speed

    def _toward(self, speed: Array, turn: float) -> None:
        share = CONTROL_DT / (SMOOTH_S + CONTROL_DT)
        self._speed = self._speed + share * (speed - self._speed)
        self.turn += share * (turn - self.turn)
        fast = float(np.hypot(*self._speed))
        self.moving = self.found and fast > (HALT if self.moving else GO)

    def _find(self, t: float, place: Array) -> None:
        self._recent.append((t, place))
        while self._recent[0][0] < t - FOUND_S:
            self._recent.popleft()
        self.found = self.found or float(np.hypot(*(place - self._recent[0][1]))) > FOUND_M


class TravelWalk(FrameByFrame):
    """The walk expert of whoever moves through space: rules in place of weights.

    path: is kept up to date by whoever owns it, once a control period before the expert is asked.
    It need not see what the robot does not follow: the robot sets off from a stand, beside them.
    """

    remembers = False

    def __init__(self, path: PathReader) -> None:
        self.path = path

    def begin(self) -> "TravelStride":
        """Start anew beside the person."""
        return TravelStride(self.path)


class TravelStride:
    """The robot's way beside one person; steps on the spot where they march there. One thread."""

    def __init__(self, path: PathReader) -> None:
        self.path, self.march = path, MarchReader()
        self._stepper, self._striding = Stepper("travel"), Striding()
        self._apart = True  # nobody to be beside yet

    def _anchor(self) -> None:
        """From here on the robot's way is told from where both are now."""
        self._from, self._facing = np.array(self.path.pos), self.path.heading
        self._pos0, self._yaw0 = self._striding.place
        self._apart = False

    def __call__(self, triplet: NDArray) -> Mapped:
        """One control period's triplet (3F,) to what an expert says of it."""
        march = self.march.step(np.asarray(triplet[:FEATURE_DIM], np.float64))
        if self._apart or not self.path.moving:
            self._anchor()
        if self.path.moving:
            forward, left, turn = self._beside()
        else:
            forward, left, turn = march.speed, 0.0, march.turn
        goes = self.path.moving or forward > 0.0
        cadence = trot_cadence(forward, left, turn) if goes else 0.0
        return self._striding.step(self._stepper.step(CONTROL_DT, cadence, forward, left, turn))

    def _beside(self) -> tuple[float, float, float]:
        """Velocity (m/s, m/s, rad/s) that keeps the robot's reference beside the person."""
        path = self.path
        pos, yaw = self._striding.place
        turned = self._yaw0 - self._facing  # from the person's world to the reference's
        aim = self._pos0 + geometry.turn_xy(path.pos - self._from, turned)
        lag = aim - pos
        far = float(np.hypot(*lag))
        if far > MAX_LAG:
            self._from = self._from + geometry.turn_xy(lag * (1.0 - MAX_LAG / far), -turned)
            lag = lag * (MAX_LAG / far)
        velocity = geometry.turn_xy(geometry.turn_xy(path.vel, turned) + lag / CATCH_UP_S, -yaw)
        off = geometry.wrap_angle(path.heading + turned - yaw)
        turn = min(max(path.turn + float(off) / FACE_S, -MAX_SPIN), MAX_SPIN)
        forward = min(max(float(velocity[0]), -gait.MAX_BACK), gait.MAX_SPEED)
        return forward, min(max(float(velocity[1]), -gait.MAX_SIDE), gait.MAX_SIDE), turn
