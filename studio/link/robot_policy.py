"""References to motor targets on the robot's side: policies, their filter, a way to a stand."""

import numpy as np
from numpy.typing import NDArray

from studio.control.controllers import Controller, ControllerInput
from studio.control.footing import over_feet
from studio.control.stand_by import StandBy
from studio.reference.intent import StateName
from studio.robot.pose import ReferencePose, RobotState
from studio.sim.actuation import MotorTargets

Array = NDArray[np.float64]


class RobotPolicy:
    """Called once a control period (1/30 s), on the robot's clock. One thread."""

    def __init__(self, controller: Controller, *, filters: bool = True) -> None:
        """filters: the controller's actions are filtered and limited; False for one that does."""
        self._controller, self._motors, self._stand_by = controller, MotorTargets(), StandBy()
        self._filters = filters

    @property
    def stands(self) -> bool:
        """The way to a stand has been gone."""
        return self._stand_by.stands

    def begin(self, robot: RobotState, target: Array) -> None:
        """The robot stands, its motors held to target (12,) rad: policies act from here on."""
        stance = over_feet(robot.foot_pos_w, "stand")
        self._stand_by.reset("stand", stance.base_pos[:2], stance.yaw)
        self._controller.reset(
            ControllerInput(reference=self._stand_by.reference, robot=robot, state="stand")
        )
        self._motors.reset(target)

    def follow(
        self, reference: ReferencePose, state: StateName, in_transition: bool, robot: RobotState
    ) -> Array:
        """(12,) rad for the motors: the reference of this period, as in `ControllerInput`."""
        self._stand_by.see(reference, state, in_transition)
        return self._act(reference, state, in_transition, robot)

    def come_to_stand(self, robot: RobotState) -> Array:
        """(12,) rad for the motors: the next period of the way to a stand, or of standing."""
        way = self._stand_by.come_to_stand()
        return self._act(way.reference, way.expert, way.state == "transition", robot)

    def _act(
        self, reference: ReferencePose, state: StateName, in_transition: bool, robot: RobotState
    ) -> Array:
        now = ControllerInput(
            reference=reference, robot=robot, state=state, in_transition=in_transition
        )
        action = self._controller.act(now)
        return self._motors.step(action) if self._filters else action
