"""PyBullet and its own A1, which nobody trained on: other masses, another trunk, other contacts."""

import math
from importlib import import_module
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studio import geometry
from studio.errors import StudioError
from studio.link.engine import LYING, RATES, Engine, MotorCommand
from studio.robot import a1, kinematics
from studio.robot.pose import RobotPose, RobotState

Array = NDArray[np.float64]
_PARTS = {"hip": "hip_joint", "thigh": "upper_joint", "calf": "lower_joint"}
"""Our joints' names, in its URDF. Axes, zeros and ranges are the same."""
_INNER_RATE = 1200.0
"""1/s, at least: how often its PD law is evaluated. It has no rotor inertia to steady it."""


class PybulletEngine(Engine):
    """Feet on a plane, friction as its files say; links pass through each other. One thread."""

    def __init__(self, rate: int = RATES[0]) -> None:
        """StudioError where PyBullet is not installed."""
        try:
            self._p: Any = import_module("pybullet")
            data: Any = import_module("pybullet_data")
        except ImportError as error:
            raise StudioError(
                "engine 'pybullet' is not installed: pip install 'a1-studio[pybullet]'"
            ) from error
        p, self.dt = self._p, 1.0 / rate
        self._client = p.connect(p.DIRECT)
        self._inner = math.ceil(_INNER_RATE / rate)
        p.setAdditionalSearchPath(data.getDataPath(), physicsClientId=self._client)
        p.setGravity(0.0, 0.0, -a1.GRAVITY, physicsClientId=self._client)
        p.setTimeStep(self.dt / self._inner, physicsClientId=self._client)
        self._floor = p.loadURDF("plane.urdf", physicsClientId=self._client)
        self._robot = p.loadURDF("a1/a1.urdf", [0.0, 0.0, 0.4], physicsClientId=self._client)
        count = p.getNumJoints(self._robot, physicsClientId=self._client)
        about = [p.getJointInfo(self._robot, j, physicsClientId=self._client) for j in range(count)]
        joints = {info[1].decode(): info[0] for info in about}
        links = {info[12].decode(): info[0] for info in about}
        self._joints = [joints[f"{leg}_{_PARTS[part]}"] for leg in a1.LEGS for part in _PARTS]
        self._feet = [links[f"{leg}_toe"] for leg in a1.LEGS]
        trunk = p.getDynamicsInfo(self._robot, -1, physicsClientId=self._client)
        self._com, self._com_quat = np.array(trunk[3]), _wxyz(trunk[4])
        p.setJointMotorControlArray(
            self._robot, self._joints, p.VELOCITY_CONTROL, forces=[0.0] * 12,
            physicsClientId=self._client,
        )  # fmt: skip
        self._t = 0.0
        self._torque: Array = np.zeros(12)
        self._state = self.place(LYING)

    def state(self) -> RobotState:
        """As after the last step."""
        return self._state

    def step(self, command: MotorCommand) -> RobotState:
        """One step, its PD law evaluated several times in it."""
        p, peak = self._p, np.zeros(12)
        for _ in range(self._inner):
            q, qd = self._joint_state()
            torque = command.kp * (command.target - q) - command.kd * qd
            torque = np.clip(torque, -a1.TORQUE_LIMIT, a1.TORQUE_LIMIT)
            p.setJointMotorControlArray(
                self._robot, self._joints, p.TORQUE_CONTROL, forces=torque.tolist(),
                physicsClientId=self._client,
            )  # fmt: skip
            p.stepSimulation(physicsClientId=self._client)
            peak = np.where(np.abs(torque) > np.abs(peak), torque, peak)
        self._t, self._torque = self._t + self.dt, peak
        self._state = self._read()
        return self._state

    def place(self, pose: RobotPose) -> RobotState:
        """Lowest point on the floor, at rest."""
        p, quat = self._p, geometry.normalize(pose.base_quat)
        pos = np.array([pose.base_pos[0], pose.base_pos[1], 0.0])
        pos[2] = 0.005 - kinematics.lowest_point(pos, quat, pose.joint_pos)
        com = pos + geometry.quat_rotate(quat, self._com)
        turned = geometry.quat_mul(quat, self._com_quat)
        p.resetBasePositionAndOrientation(
            self._robot, com.tolist(), np.roll(turned, -1).tolist(), physicsClientId=self._client
        )
        zero = [0.0, 0.0, 0.0]
        p.resetBaseVelocity(self._robot, zero, zero, physicsClientId=self._client)
        for joint, angle in zip(self._joints, pose.joint_pos.tolist(), strict=True):
            p.resetJointState(self._robot, joint, angle, 0.0, physicsClientId=self._client)
        self._torque = np.zeros(12)
        self._state = self._read()
        return self._state

    def _joint_state(self) -> tuple[Array, Array]:
        states = self._p.getJointStates(self._robot, self._joints, physicsClientId=self._client)
        return np.array([s[0] for s in states]), np.array([s[1] for s in states])

    def _read(self) -> RobotState:
        p, robot, client = self._p, self._robot, self._client
        com, xyzw = p.getBasePositionAndOrientation(robot, physicsClientId=client)
        lin, ang = (np.array(v) for v in p.getBaseVelocity(robot, physicsClientId=client))
        # PyBullet tells of the trunk's centre of mass: the trunk's origin is beside it.
        quat = geometry.quat_mul(_wxyz(xyzw), geometry.quat_conj(self._com_quat))
        arm = geometry.quat_rotate(quat, self._com)
        pos, joint_pos_vel = np.array(com) - arm, self._joint_state()
        touching = p.getContactPoints(robot, self._floor, physicsClientId=client)
        links = {point[3] for point in touching if point[9] > 0.0}
        return RobotState(
            base_pos=pos,
            base_quat=-quat if quat[0] < 0.0 else quat,
            joint_pos=joint_pos_vel[0],
            foot_contact=np.array([float(foot in links) for foot in self._feet]),
            t=self._t,
            base_lin_vel_w=lin - np.cross(ang, arm),
            base_ang_vel_b=geometry.quat_rotate_inverse(quat, ang),
            joint_vel=joint_pos_vel[1],
            foot_pos_w=kinematics.foot_pos_w(pos, quat, joint_pos_vel[0]),
            torque=self._torque,
            trunk_contact=-1 in links,
        )

    def close(self) -> None:
        """Let go of its world."""
        self._p.disconnect(physicsClientId=self._client)


def _wxyz(xyzw: Any) -> Array:
    return np.roll(np.array(xyzw, dtype=np.float64), 1)
