"""A scene being played: robot and world it is set in, what has been done in it, and when."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from typing_extensions import TypedDict

from studio import geometry, metrics
from studio.errors import StudioError
from studio.link.link import Order, RobotLink
from studio.link.sim import SimLink
from studio.robot.a1 import CONTROL_DT
from studio.robot.pose import RobotPose, RobotState
from studio.scenes.registry import scene as scene_of
from studio.scenes.scene import Seen, Step
from studio.scenes.thrower import Thrower
from studio.sim.prop_world import PropPoses, PropWorld
from studio.sim.pull import Pull
from studio.sim.world import World

Array = NDArray[np.float64]
Place = tuple[Array, float]
"""Where a robot stands: (2,) m in the world, and its heading, rad."""
WORTH, SLOWEST, PENALTY = 100.0, 0.5, 20.0
"""Points of a step done at once; the share of them that one done in the last moment is worth; what
each touch of what is to be avoided, and each thrown ball that hit, costs."""
_TOUCH_AGAIN = 1.0
"""s after which another touch of the same thing counts anew."""
_MOVED, _LEANT = 0.04, np.cos(np.radians(3.0))
"""m from where it began, and cosine of a lean, from which the clock runs."""
OUT_OF_TIME = "out of time"


class StepDone(TypedDict):
    """One step of a scene. text: what to do. t: s on the scene's clock when it was done."""

    text: str
    done: bool
    t: float | None


class Progress(TypedDict):
    """How far a scene has come. step: of the steps, the one to do; their number once all are done.
    failed: why it cannot be finished any more, or None."""

    name: str
    step: int
    steps: list[StepDone]
    score: int
    time_s: float
    finished: bool
    failed: str | None


@dataclass(frozen=True, kw_only=True)
class Done:
    """A step that was done, t s into the scene, worth so many points."""

    t: float
    points: float


class Stage:
    """The world and a scene's progress in it. One thread; the same seed and targets, the same run.

    The clock runs from the robot's first movement until the last step is done, or it fails. link:
    drives the robot.
    """

    def __init__(self, name: str, seed: int = 0, link: RobotLink | None = None) -> None:
        """link: its robot is set into the scene (default: a simulated one of its own).

        StudioError for an unknown scene, or one with props for a robot that is not simulated here.
        """
        self.name, self.scene = name, scene_of(name)
        self.link, props = link or SimLink(), self.scene.props
        if self.link.simulated:
            self.link.enter(PropWorld(props, seed) if props else World(seed=seed))
        elif props:
            raise StudioError(f"scene {name!r} is for the simulated robot, not {self.link.name}")
        self._pull, self._robot = Pull(), self.link.sense()
        self._clear()

    @property
    def world(self) -> World:
        """Of the simulated robot. StudioError where the robot is another."""
        return self.link.world

    @property
    def start(self) -> tuple[Array, float]:
        """Where the scene begins: (2,) m, heading rad; a robot that cannot be placed is there."""
        x, y, yaw = self.scene.start
        placed = (np.array([x, y]), yaw)
        return placed if self.link.simulated else self.restart_at(self.link.sense())

    def restart_at(self, robot: RobotState) -> Place:
        """Where a robot that is set upright stands. Among props, the start."""
        return self.start if self.scene.props else (robot.base_pos[:2], robot.yaw)

    def reset(self, pose: RobotPose) -> RobotState:
        """The scene from its beginning, the robot at rest in `pose`."""
        self._clear()
        state = self._robot = self.link.place(pose)
        if self.scene.props:
            world = self._prop_world
            for name, by in self.scene.scatter.items():
                world.put(name, world.props[name].pos + world.rng.uniform(-1.0, 1.0, 3) * by)
            self.seen = self._look(world, state)
        self._from = state
        return state

    def step(self, order: Order) -> RobotState:
        """One control period of the robot under this order, and what came of it."""
        if self.link.simulated:
            self._pull.step(self.world, order.damping)
        state = self._robot = self.link.exchange(order)
        if self.link.simulated:  # judged by the world, whatever has arrived of it
            self._robot = self.world.state
        if self.scene.props:
            world = self._prop_world
            self.seen = self._look(world, self._robot)
            if self.step_now is not None and self.failed is None:
                self._play(world, self.step_now, self.seen)
        return state

    @property
    def _prop_world(self) -> PropWorld:
        assert isinstance(self.world, PropWorld)
        return self.world

    def push(self, force: ArrayLike, seconds: float) -> None:
        """Somebody's hand at the trunk (`sim.pull`): (3,) N, world, for so long. The run is no
        longer the driver's alone. StudioError for a robot that is not simulated here."""
        _ = self.world
        self._pull.ask(force, seconds)
        self.pushed = True

    @property
    def push_force(self) -> Array:
        """(3,) N, world: what pushes the robot now."""
        return self._pull.force

    def prop_poses(self) -> PropPoses | None:
        """Where props are; None without any. Of the thread that steps."""
        return self._prop_world.poses() if self.scene.props else None

    def move_robot(self, to: RobotPose) -> RobotState:
        """The robot goes on where `to` is and faces; among props it stays where it is, and so
        does one that is not simulated here."""
        if self.scene.props or not self.link.simulated:
            return self.link.sense()
        self._robot = self.world.move_base(to.base_pos[:2], to.yaw)
        return self._robot

    def fallen(self, reference: RobotPose) -> bool:
        """The robot has fallen, whose reference is this; then the scene has failed."""
        robot = self._robot
        fell = metrics.fallen(robot.trunk_contact, robot.base_quat, reference.base_quat)
        if fell and self.link.ready:
            self._fail("the robot fell")
        return bool(fell) and self.link.ready

    @property
    def step_now(self) -> Step | None:
        """What there is to do."""
        steps, k = self.scene.steps, len(self.done)
        return steps[k] if k < len(steps) else None

    @property
    def finished(self) -> bool:
        """All is done that there was to do."""
        return bool(self.scene.steps) and self.step_now is None

    def progress(self) -> Progress:
        """For whoever looks on."""
        steps = self.scene.steps
        times: list[float | None] = [round(d.t, 2) for d in self.done]
        times += [None] * (len(steps) - len(times))
        return Progress(
            name=self.name,
            step=len(self.done),
            steps=[
                StepDone(text=step.goal, done=t is not None, t=t)
                for step, t in zip(steps, times, strict=True)
            ],
            score=round(max(sum(d.points for d in self.done) - self.penalty, 0.0)),
            time_s=round(self.time, 2),
            finished=self.finished,
            failed=self.failed,
        )

    # --------------------------------------------------------------------------------------------

    def _fail(self, why: str) -> None:
        """It cannot be finished any more, unless it has been already."""
        if self.step_now is not None and self.failed is None:
            self.failed = why

    def _clear(self) -> None:
        self.done: list[Done] = []
        self.failed: str | None = None
        self.time, self.penalty, self.pushed = 0.0, 0.0, False
        self._pull.let_go()
        self.seen: Seen | None = None
        self._begun, self._held, self._step_t = False, 0.0, 0.0
        self._touched_at: dict[str, float] = {}
        self._thrower: Thrower | None = None

    def _look(self, world: PropWorld, state: RobotState) -> Seen:
        dodged = self._thrower is not None and self._thrower.dodged
        where = {name: world.position(name) for name in world.props}
        return Seen(robot=state, pos=where, touched=world.touched, dodged=dodged)

    def _play(self, world: PropWorld, step: Step, seen: Seen) -> None:
        self._begun = self._begun or self._moved(seen.robot)
        if self._begun:
            self.time += CONTROL_DT
            self._step_t += CONTROL_DT
        if step.throw is not None:
            self._thrower = self._thrower or Thrower(step.throw, world)
            self.penalty += PENALTY * self._thrower.step(seen)
        self._avoid(seen)
        self._held = self._held + CONTROL_DT if step.done(seen) else 0.0
        if self._held > step.hold:
            worth = 1.0 - (1.0 - SLOWEST) * min(self._step_t / step.within, 1.0)
            self.done.append(Done(t=self.time, points=WORTH * worth))
            self._held, self._step_t, self._thrower = 0.0, 0.0, None
        elif self._step_t > step.within:
            self._fail(OUT_OF_TIME)

    def _avoid(self, seen: Seen) -> None:
        for name in {name for name, _ in seen.touched} & set(self.scene.avoid):
            if self.time - self._touched_at.get(name, -np.inf) > _TOUCH_AGAIN:
                self.penalty += PENALTY
            self._touched_at[name] = self.time

    def _moved(self, robot: RobotState) -> bool:
        way = np.linalg.norm(robot.base_pos - self._from.base_pos)
        up, before = (geometry.up_in_body(p.base_quat) for p in (robot, self._from))
        return bool(way > _MOVED or np.dot(up, before) < _LEANT)
