"""One simulated A1: joint targets at 30 Hz to the robot's state, through MuJoCo."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray

from studio import geometry
from studio.errors import StudioError
from studio.robot import a1, kinematics
from studio.robot.pose import RobotPose, RobotState
from studio.sim import randomize
from studio.sim.motors import MotorModel
from studio.sim.spec import ModelConfig, Prop, build_model

Array = NDArray[np.float64]

_VARIED = ("body_mass", "body_inertia")
_HOME = RobotPose(
    base_pos=np.array([0.0, 0.0, a1.STAND_HEIGHT]),
    base_quat=geometry.IDENTITY_QUAT,
    joint_pos=a1.STAND_JOINT_POS,
    foot_contact=np.ones(4),
)


@dataclass(frozen=True, kw_only=True)
class WorldConfig:
    """One robot's world.

    model: how it is built. damping_kd: joint damping of the damping mode, N m s/rad (Unitree's
    soft stop: no stiffness, only damping). motor: its torque-speed curve. stop_rate: 1/s, a joint
    nears its stop at no more than this times what is left to it.
    """

    model: ModelConfig = field(default_factory=ModelConfig)
    damping_kd: float = 4.0
    motor: MotorModel = field(default_factory=MotorModel)
    stop_rate: float = 25.0


class World:
    """The world and its one robot; remembers, so it has `reset`. One thread at a time.

    `model`, `data`: MuJoCo's own; `state`: last returned; `rng`: of `seed`, the physics has none.
    """

    def __init__(
        self, config: WorldConfig = WorldConfig(), seed: int = 0, props: Sequence[Prop] = ()
    ) -> None:
        self.config = config
        self.rng = np.random.default_rng(seed)
        self.model = build_model(config.model, props)
        self.data = mujoco.MjData(self.model)
        periods = a1.CONTROL_DT / config.model.timestep
        self.substeps = round(periods)
        if abs(periods - self.substeps) > 1e-6 or self.substeps < 8:
            raise StudioError(
                f"timestep {config.model.timestep} does not fit: use 1/240 s or a whole fraction"
                " of it"
            )
        self._classify_geoms()
        self._nominal = {name: np.array(getattr(self.model, name)) for name in _VARIED}
        self._kp, self._kd, self._delay = config.model.kp, config.model.kd, 0.0
        self._ground = geometry.IDENTITY_QUAT
        self._full_below = config.motor.full_below(a1.TORQUE_LIMIT)
        self.damping = False
        self.state = self.reset()

    def set_dynamics(self, drawn: randomize.Dynamics) -> None:
        """A robot and a ground other than the nominal ones: one draw of Table I, absolute.

        The floor itself is tilted, about the origin: base_quat stays what an IMU would say. The
        jitter of the control period is not applied. Call `reset` after it.
        """
        assert len(drawn) == 1
        model = self.model
        links = np.flatnonzero(self._nominal["body_mass"] > 0.0)
        factor = np.ones(model.nbody)
        factor[links[: drawn.mass.shape[1]]] = drawn.mass[0]
        model.body_mass[:] = self._nominal["body_mass"] * factor
        model.body_inertia[:] = self._nominal["body_inertia"] * factor[:, None]
        model.geom_friction[:, 0] = drawn.friction[0]
        self._kp = self.config.model.kp * float(drawn.kp[0])
        self._kd = self.config.model.kd * float(drawn.kd[0])
        self._delay = float(drawn.delay[0])
        armature, damping, limit = (x[0] for x in drawn.motors(self.config.model.armature))
        model.dof_armature[6:18], model.dof_damping[6:18] = armature, damping
        model.actuator_forcerange[:12] = np.stack([-limit, limit], axis=-1)
        self._full_below = self.config.motor.full_below(limit)
        self._ground = geometry.quat_from_rotvec(np.append(drawn.slope_axis[0], 0.0))
        model.geom_quat[model.geom("floor").id] = self._ground
        mujoco.mj_setConst(model, self.data)
        self.set_damping(self.damping)

    def _classify_geoms(self) -> None:
        model = self.model
        names = [model.geom(i).name for i in range(model.ngeom)]
        body = [model.body(int(b)).name for b in model.geom_bodyid]
        feet = {f"{leg}_foot": i for i, leg in enumerate(a1.LEGS)}
        self._geom_foot = np.array([feet.get(n, -1) for n in names])
        self._geom_robot = np.array([b in a1.LINKS for b in body])
        # A pair that adds up to 3 is the trunk on the ground.
        self._geom_down = np.array([{"trunk": 1, "world": 2}.get(b, 0) for b in body])

    def reset(self, pose: RobotPose | None = None) -> RobotState:
        """The robot at rest in `pose` (neutral stand if None), lowest point on the floor, at t = 0.

        x, y, orientation and joints are the pose's; joints are clipped to their limits. Props
        return to their places. The damping mode is left. Raises StudioError for a pose that is not
        finite or whose quaternion has no length.
        """
        pose = _HOME if pose is None else pose
        values = np.concatenate([pose.base_pos, pose.base_quat, pose.joint_pos])
        if not np.all(np.isfinite(values)) or np.linalg.norm(pose.base_quat) < 1e-6:
            raise StudioError("the pose to reset to must be finite, with a unit quaternion")
        mujoco.mj_resetData(self.model, self.data)
        self.set_damping(False)
        quat = geometry.normalize(pose.base_quat)
        joint_pos = np.clip(pose.joint_pos, a1.JOINT_LOWER, a1.JOINT_UPPER)
        base_pos = np.array([pose.base_pos[0], pose.base_pos[1], 0.0])
        base_pos[2] = -kinematics.lowest_point(base_pos, quat, joint_pos)
        if self._ground is not geometry.IDENTITY_QUAT:
            base_pos = geometry.quat_rotate(self._ground, base_pos)
            quat = geometry.quat_mul(self._ground, quat)
        self.data.qpos[:3], self.data.qpos[3:7], self.data.qpos[7:19] = base_pos, quat, joint_pos
        self._target = self.data.ctrl[:12] = joint_pos
        mujoco.mj_forward(self.model, self.data)
        self.state = self._read(np.zeros(12))
        return self.state

    def step(self, target: ArrayLike, steps: int | None = None) -> RobotState:
        """One control period (1/30 s), or `steps` physics steps, towards joint targets (12,) rad.

        The PD law, the torque limit and the fall of torque near the speed limit hold at every
        physics step. Targets beyond the joint limits are clipped. Raises StudioError, and changes
        nothing, for targets that are not twelve finite numbers.
        """
        target = np.asarray(target, dtype=np.float64)
        if target.shape != (12,) or not np.isfinite(target).all():
            raise StudioError("a target must be 12 finite joint angles in rad (a1.JOINTS)")
        target = np.minimum(np.maximum(target, a1.JOINT_LOWER), a1.JOINT_UPPER)
        data, late, self._target = self.data, self._target, target
        speed, torque = data.qvel[6:18], data.actuator_force
        peak, peak_size = np.zeros(12), np.zeros(12)
        for k in range(steps or self.substeps):
            target = self._target if self._delay == 0.0 else self._after_delay(late, k)
            data.ctrl[:12] = target
            if max(speed.max(), -speed.min()) > self._full_below:
                data.ctrl[:12] = self._within_motor_curve(target)
            self._substep()
            size = np.abs(torque[:12])
            larger = size > peak_size
            peak[larger], peak_size[larger] = torque[:12][larger], size[larger]
        if not np.isfinite(data.qpos[:19]).all():
            raise StudioError("the simulation diverged; reset the robot")
        self.state = self._read(peak)
        return self.state

    def _substep(self) -> None:
        mujoco.mj_step(self.model, self.data)

    def _after_delay(self, late: Array, substep: int) -> Array:
        """The motors' target in a substep of one that comes `_delay` s late."""
        dt = self.config.model.timestep
        share = min(max(((substep + 1) * dt - self._delay) / dt, 0.0), 1.0)
        return (1.0 - share) * late + share * self._target

    def _within_motor_curve(self, target: Array) -> Array:
        """Targets whose torque stays under the motor's torque-speed curve at the present speed.

        Near a stop the free speed shrinks. Inverts torque = kp (target - q) - kd qd.
        """
        if self.damping:
            return target
        q, qd = self.data.qpos[7:19], self.data.qvel[6:18]
        kp, kd = self._kp, self._kd
        rate = self.config.stop_rate
        back, ahead = rate * (q - a1.JOINT_LOWER), rate * (a1.JOINT_UPPER - q)
        lower, upper = self.config.motor.torques(qd, back, ahead)
        rest = kd * qd
        target = np.minimum(target, q + (upper + rest) / kp)
        return np.maximum(target, q + (lower + rest) / kp)

    def move_base(self, base_xy: ArrayLike, yaw: float) -> RobotState:
        """Its state, moved to base_xy (2,) m and heading yaw rad as it moves; props stay."""
        data = self.data
        by = float(geometry.wrap_angle(yaw - geometry.heading(data.qpos[3:7])))
        turn = geometry.quat_from_rotvec([0.0, 0.0, by])
        data.qpos[:2] = np.asarray(base_xy, dtype=np.float64)
        data.qpos[3:7] = geometry.quat_mul(turn, data.qpos[3:7])
        data.qvel[:3] = geometry.quat_rotate(turn, data.qvel[:3])
        data.qacc_warmstart[:3] = geometry.quat_rotate(turn, data.qacc_warmstart[:3])
        mujoco.mj_forward(self.model, data)
        self.state = self._read(self.state.torque)
        return self.state

    def push(self, delta_lin_vel_w: ArrayLike) -> None:
        """Add (3,) m/s to the base's velocity, world frame: a kick. StudioError if not finite."""
        delta = np.asarray(delta_lin_vel_w, dtype=np.float64)
        if delta.shape != (3,) or not np.isfinite(delta).all():
            raise StudioError("a push is three finite numbers: the change of velocity in m/s")
        self.data.qvel[:3] += delta

    def set_damping(self, on: bool) -> None:
        """Damping mode: no stiffness, only damping, whatever the targets; off restores the PD."""
        self.damping = on
        self._use_gains(*((0.0, self.config.damping_kd) if on else (self._kp, self._kd)))

    def set_gains(self, kp: float, kd: float) -> None:
        """The PD's: N m/rad, N m s/rad. No stiffness is the damping mode."""
        self.damping, self._kp, self._kd = kp == 0.0, kp, kd
        self._use_gains(kp, kd)

    def _use_gains(self, kp: float, kd: float) -> None:
        self.model.actuator_gainprm[:12, 0] = kp
        self.model.actuator_biasprm[:12, 1] = -kp
        self.model.actuator_biasprm[:12, 2] = -kd

    def _read(self, torque: Array) -> RobotState:
        data = self.data
        foot, trunk, itself = np.zeros(4), False, False
        if data.ncon:
            pairs = data.contact.geom[data.contact.dist < 1e-3]
            robot = self._geom_robot[pairs]
            both = robot.all(axis=1)
            itself = bool(both.any())
            outside = pairs[robot.any(axis=1) & ~both]
            touched = self._geom_foot[outside.ravel()]
            foot[touched[touched >= 0]] = 1.0
            trunk = bool((self._geom_down[outside].sum(axis=1) == 3).any())
        pos, quat = data.qpos[:3].copy(), geometry.normalize(data.qpos[3:7])
        joint_pos = data.qpos[7:19].copy()
        return RobotState(
            base_pos=pos,
            base_quat=-quat if quat[0] < 0.0 else quat,
            joint_pos=joint_pos,
            foot_contact=foot,
            t=float(data.time),
            base_lin_vel_w=data.qvel[:3].copy(),
            base_ang_vel_b=data.qvel[3:6].copy(),
            joint_vel=data.qvel[6:18].copy(),
            foot_pos_w=kinematics.foot_pos_w(pos, quat, joint_pos),
            torque=torque,
            trunk_contact=trunk,
            self_collision=itself,
        )
