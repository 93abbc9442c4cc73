"""What the scripted operator sees of a scene: from outside, or through the robot's own camera.

    third_person   robot and props in the room, as the page shows them (`scene_operator.Eyes`)
    camera         what the robot's camera sees; nothing of the robot itself
    camera_state   that, and the robot's measured state: where it is, how it leans

Whoever sees by the camera has read the scene's plan, where things begin but for their scatter. What
is in the picture is placed from it, and what left it is remembered: carried on by the robot's state
or, without one, by what the operator asked for, as far as they know how the robot answers. What is
not found where it should be in the picture is forgotten, and looked for; so is, without the
robot's state, what all was tried at in vain.
"""

from collections import deque
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from studio import geometry
from studio.evaluation.scene_operator import Eyes, Sight
from studio.reference.intent import Intent
from studio.reference.stances import NEUTRAL
from studio.robot import camera
from studio.robot.a1 import CONTROL_DT
from studio.scenes.stage import Stage
from studio.sim.prop_world import PropWorld
from studio.sim.props import PropShape

Array = NDArray[np.float64]
View = Literal["third_person", "camera", "camera_state"]

RANGE_BLUR = 0.02
"""Share, standard deviation, by which a distance is misjudged, besides `BLUR_M`."""
MIDDLE, MISSES_S = 0.8, 1.0
"""Share of the picture, from its middle, in which a thing is missed that should be there, and s
until it is given up."""

# How the robot answers, as whoever has driven it for a while knows: fitted to runs of other seeds.
SPEED_OF = {0.75: 0.3, 0.5: 0.12}
"""m/s of the marches of so many strides a second."""
TURN_GAIN = 0.57
"""rad/s turned of one asked for."""
STARTS_AFTER, STOPS_AFTER, TURNS_AFTER, SITS_AFTER, SETTLES = 2.1, 0.6, 1.0, 2.7, 0.3
"""s of marching until it walks, of none until it stops; until it turns, and sits, as asked; s of
first-order lag of speed and turn."""
SITS_BACK, SIT_PITCH = 0.33, np.radians(-70.0)
"""m by which the trunk goes back as it sits; rad, its pitch then."""


class CameraEyes(Eyes):
    """By the camera and the robot's measured state, late."""

    def __init__(self, stage: Stage, rng: np.random.Generator) -> None:
        super().__init__(stage, rng)
        shapes = [prop for prop in stage.scene.props if prop.held != "ground"]
        self._shapes = {prop.name: prop for prop in shapes}
        self._pos = {prop.name: np.array(prop.pos) for prop in shapes}
        self._missed = dict.fromkeys(self._pos, 0.0)
        self._lost: dict[str, Array] = {}
        self._seen: frozenset[str] = frozenset()

    def _look(self, step: str, meant: Intent) -> Sight:
        base, quat = self._base, self._quat = self._robot(meant)
        seen = self._in_view()
        self._seen = frozenset(seen)
        for name, point_b in seen.items():
            self._pos[name] = base + geometry.quat_rotate(quat, point_b)
            self._missed[name] = 0.0
            self._lost = {n: where for n, where in self._lost.items() if n != name}
        for name in self._pos.keys() - seen.keys():
            self._miss(name, geometry.quat_rotate_inverse(quat, self._pos[name] - base), seen)
        yaw = float(geometry.heading(quat))
        turning = self._turning(yaw)
        return Sight(
            step=step, base=base, yaw=yaw, turning=turning, pos=dict(self._pos), lost=self._lost
        )

    def _robot(self, meant: Intent) -> tuple[Array, Array]:
        """Where the operator takes the trunk to be: (3,) m, (4,) wxyz, world."""
        robot = self._stage.link.sense()
        return robot.base_pos, robot.base_quat

    def _in_view(self) -> dict[str, Array]:
        """(3,) m in the trunk's frame, as the picture tells: of the props of which it shows the
        middle, or of a mark a part."""
        world, seen = self._stage.world, self._stage.seen
        if seen is None or not isinstance(world, PropWorld):
            return {}
        base, quat = seen.robot.base_pos, seen.robot.base_quat
        eye = base + geometry.quat_rotate(quat, camera.MOUNT)
        found = {}
        for name, shape in self._shapes.items():
            points = seen.pos[name] + _parts(shape)
            inside = camera.in_picture(geometry.quat_rotate_inverse(quat, points - base))
            if not all(world.hidden(eye, point, name) for point in points[inside]):
                gap = geometry.quat_rotate_inverse(quat, seen.pos[name] - eye)
                gap = gap * (1.0 + RANGE_BLUR * self._rng.standard_normal())
                found[name] = camera.MOUNT + self._blurred(gap)
        return found

    def _miss(self, name: str, at_b: Array, seen: dict[str, Array]) -> None:
        """It is not in the picture. at_b: (3,) m, where it should be, in the trunk's frame."""
        if not camera.in_picture(at_b, MIDDLE) or any(
            _covers(self._shapes[other], point, at_b) for other, point in seen.items()
        ):
            self._missed[name] = 0.0
            return
        self._missed[name] += CONTROL_DT
        if self._missed[name] > MISSES_S:
            self._forget(name)

    def _forget(self, name: str) -> None:
        gap = self._pos.pop(name)[:2] - self._base[:2]
        where = geometry.turn_xy(gap, -float(geometry.heading(self._quat)))
        self._lost = {**self._lost, name: where}


class CameraOnlyEyes(CameraEyes):
    """By the camera alone, late: the robot is where what was asked of it would have brought it."""

    def __init__(self, stage: Stage, rng: np.random.Generator) -> None:
        super().__init__(stage, rng)
        x, y, self._yaw = stage.scene.start
        self._xy, self._speed, self._turns, self._marched = np.array([x, y]), 0.0, 0.0, 0.0
        self._asked: deque[Intent] = deque(maxlen=round(SITS_AFTER / CONTROL_DT))

    def doubt(self, name: str) -> bool:
        """Where it is was counted by what was asked for alone: no longer believed."""
        if name in self._seen:
            return False
        if name in self._pos:
            self._forget(name)
        return True

    def _robot(self, meant: Intent) -> tuple[Array, Array]:
        self._asked.append(meant)
        walk, turn = self._before(STOPS_AFTER), self._before(TURNS_AFTER)
        self._marched = self._marched + CONTROL_DT if walk.state == "walk" else 0.0
        walks = self._marched > STARTS_AFTER - STOPS_AFTER
        speed = SPEED_OF.get(walk.cadence, 0.0) if walks else 0.0
        self._speed += (speed - self._speed) * CONTROL_DT / SETTLES
        self._turns += (TURN_GAIN * turn.turn - self._turns) * CONTROL_DT / SETTLES
        self._yaw += self._turns * CONTROL_DT
        ahead = np.array([np.cos(self._yaw), np.sin(self._yaw)])
        self._xy = self._xy + self._speed * CONTROL_DT * ahead
        sits = self._before(SITS_AFTER).state == "sit"
        pitch, back = (SIT_PITCH, SITS_BACK) if sits else (0.0, 0.0)
        high = NEUTRAL["sit" if sits else "stand"].base_pos[2]
        base = np.append(self._xy - back * ahead, high)
        return base, geometry.quat_from_rpy([0.0, pitch, self._yaw])

    def _before(self, seconds: float) -> Intent:
        """What was asked for so long ago."""
        ago = round(seconds / CONTROL_DT)
        return self._asked[-ago] if ago <= len(self._asked) else Intent()


def eyes_of(view: View, stage: Stage, rng: np.random.Generator) -> Eyes:
    """Whoever sees a scene that way."""
    kinds = {"third_person": Eyes, "camera": CameraOnlyEyes, "camera_state": CameraEyes}
    return kinds[view](stage, rng)


def _parts(shape: PropShape) -> Array:
    """(n, 3) m from its middle: points of which one has to be seen."""
    if shape.held != "drawn":
        return np.zeros((1, 3))
    near_rim = 0.9 * shape.size[0]
    return near_rim * np.array([[0, 0, 0], [1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0]])


def _covers(shape: PropShape, point_b: Array, at_b: Array) -> bool:
    """Something seen at a point hides another place, (3,) m in the trunk's frame each."""
    near, far = point_b - camera.MOUNT, at_b - camera.MOUNT
    along = float(near @ far / np.linalg.norm(far))
    beside = np.linalg.norm(near - along * far / np.linalg.norm(far))
    return bool(0.0 < along < np.linalg.norm(far) and beside < max(shape.size))
