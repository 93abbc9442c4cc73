"""Intents of walking → what an expert says of them: the generator's own steps, frame by frame."""

import numpy as np
from numpy.typing import NDArray

from studio import geometry
from studio.geometry import scalars
from studio.reference.intent import Intent
from studio.reference.realize import Realizer
from studio.retarget.mapper import NUM_RATES, RATES, Mapped
from studio.robot.a1 import CONTROL_DT

Array = NDArray[np.float64]


class Striding:
    """Walks on from standing at the origin, one intent a control period. One thread.

    place: (2,) m and rad, where its robot is and faces, on a floor of its own.
    """

    def __init__(self) -> None:
        self._realizer = Realizer()
        self.place: tuple[Array, float] = (np.zeros(2), 0.0)

    def step(self, intent: Intent) -> Mapped:
        """The next frame."""
        pose = self._realizer.step(intent)
        yaw = float(geometry.heading(pose.base_quat))
        turned = geometry.wrap_angle(yaw - self.place[1])
        self.place = (pose.base_pos[:2], yaw)
        heading = np.array(scalars.yaw(yaw))
        rates = np.zeros(NUM_RATES)
        rates[RATES["joint_vel"]] = pose.joint_vel
        rates[RATES["base_lin_vel"]] = geometry.quat_rotate_inverse(heading, pose.base_lin_vel_w)
        rates[RATES["base_ang_vel"]] = pose.base_ang_vel_b
        return Mapped(
            joint_pos=pose.joint_pos,
            base_quat=geometry.quat_mul(geometry.quat_conj(heading), pose.base_quat),
            rates=rates,
            contact_prob=pose.foot_contact,
            turn=float(turned) / CONTROL_DT,
        )
