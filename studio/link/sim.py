"""The simulated robot in this process: an order is a control period of its world."""

from studio.link.link import Order, RobotLink
from studio.robot.pose import RobotPose, RobotState
from studio.sim.world import World


class SimLink(RobotLink):
    """Remembers nothing but its world. Gains are the world's own, which a study may draw."""

    name, simulated, poses = "sim", True, True

    def __init__(self, world: World | None = None) -> None:
        """world: None where one is still to be entered."""
        self._world = world

    @property
    def world(self) -> World:
        """Where the robot lives."""
        assert self._world is not None
        return self._world

    def enter(self, world: World) -> None:
        """Live in another world."""
        self._world = world

    def sense(self) -> RobotState:
        """As the world last said."""
        return self.world.state

    def exchange(self, order: Order) -> RobotState:
        """One control period (1/30 s). StudioError as `World.step`."""
        self.world.set_damping(order.damping)
        self.target = order.target
        return self.world.step(order.target)

    def place(self, pose: RobotPose) -> RobotState:
        """At rest in `pose`."""
        self.target = pose.joint_pos
        return self.world.reset(pose)
