"""N worlds on a thread pool: targets at 30 Hz → states, each with its own dynamics.

Physics is `mujoco.batch`: one model, per-simulation masses, gains, friction and gravity; PD runs
inside MuJoCo as affine actuators, so that a control period is a single call without Python.
"""

from dataclasses import dataclass, field

import mujoco
import numpy as np
from mujoco import batch as mjbatch
from numpy.typing import NDArray

from studio import geometry
from studio.robot import a1
from studio.sim import randomize
from studio.sim.motors import MotorModel
from studio.sim.spec import ModelConfig, build_spec

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class BatchConfig:
    """num_envs: simulations. threads: 0 for every core. decimation: physics steps a period.

    self_collision, leg_contact: as in sim.spec; both cost time, and only sitting needs the legs.
    motor: the torque-speed curve, as in sim.world; motor_every: physics steps between two looks at
    it.
    """

    num_envs: int = 512
    threads: int = 0
    decimation: int = 8
    self_collision: bool = False
    leg_contact: bool = False
    motor: MotorModel = field(default_factory=MotorModel)
    motor_every: int = 1


def delayed_controls(previous: Array, target: Array, delay: Array, dt: float, steps: int) -> Array:
    """(N, steps, 12) rad: the motors' targets at each substep when one comes `delay` (N,) s late.

    Before the delay has passed the previous target acts; the substep in which it passes gets the
    mean of both, weighted by time, which is what the motor's zero-order hold integrates.
    """
    begin = np.arange(steps) * dt
    share = np.clip((begin + dt - delay[:, None]) / dt, 0.0, 1.0)[..., None]
    return (1.0 - share) * previous[:, None] + share * target[:, None]


class BatchWorld:
    """N simulated A1s on a plane; one thread only. Arrays have a leading axis N."""

    def __init__(self, config: BatchConfig = BatchConfig(), seed: int = 0) -> None:
        self.config = config
        self.rng = np.random.default_rng(seed)
        self.dt = a1.CONTROL_DT / config.decimation
        model = training_model(config, self.dt)
        self.model = model
        n = config.num_envs
        self._batch = mjbatch.Batch(model, n, nthread=config.threads)
        self._mass = self._batch.expand("body_mass")
        self._inertia = self._batch.expand("body_inertia")
        self._friction = self._batch.expand("geom_friction")
        self._gain = self._batch.expand("actuator_gainprm")
        self._bias = self._batch.expand("actuator_biasprm")
        self._gravity = self._batch.expand("opt.gravity")
        self._timestep = self._batch.expand("opt.timestep")
        self._torque_range = self._batch.expand("actuator_forcerange")
        self._armature = self._batch.expand("dof_armature")
        self._damping = self._batch.expand("dof_damping")
        self._limit = np.tile(a1.TORQUE_LIMIT, (n, 1))
        self._slowed = np.zeros(n, dtype=bool)
        self.qpos = self._batch.bind("qpos")
        self.qvel = self._batch.bind("qvel")
        self.torque = self._batch.bind("actuator_force")
        self._warmstart = self._batch.bind("qacc_warmstart")
        self._links = np.flatnonzero(model.body_mass > 0.0)
        self.num_links = len(self._links)
        self.target = np.tile(a1.STAND_JOINT_POS, (n, 1))
        self.delay = np.zeros(n)
        self.slope_quat = np.tile(geometry.IDENTITY_QUAT, (n, 1))
        self.slope_axis = np.zeros((n, 2))
        self.dynamics_factors = np.tile([1.0, 1.0, 1.0], (n, 1))
        self._period = np.zeros(n)

    @property
    def base_pos(self) -> Array:
        """(N, 3) m, trunk origin in the frame of the ground."""
        return self.qpos[:, :3]

    @property
    def base_quat(self) -> Array:
        """(N, 4) wxyz in the frame of the ground."""
        return self.qpos[:, 3:7]

    @property
    def joint_pos(self) -> Array:
        """(N, 12) rad."""
        return self.qpos[:, 7:19]

    @property
    def base_lin_vel_w(self) -> Array:
        """(N, 3) m/s."""
        return self.qvel[:, :3]

    @property
    def base_ang_vel_b(self) -> Array:
        """(N, 3) rad/s, body."""
        return self.qvel[:, 3:6]

    @property
    def joint_vel(self) -> Array:
        """(N, 12) rad/s."""
        return self.qvel[:, 6:18]

    @property
    def imu_quat(self) -> Array:
        """(N, 4) the trunk in a frame whose z opposes gravity: what an IMU can know."""
        return geometry.quat_mul(self.slope_quat, self.base_quat)

    def set_dynamics(self, ids: NDArray[np.intp], drawn: randomize.Dynamics) -> None:
        """Give simulations `ids` (n,) their own dynamics, absolute (not on top of earlier ones)."""
        assert len(ids) == len(drawn)
        model = self.model
        factor = np.ones((len(ids), model.nbody))
        factor[:, self._links] = drawn.mass
        self._mass[ids] = model.body_mass * factor
        self._inertia[ids] = model.body_inertia * factor[..., None]
        friction = np.array(model.geom_friction[None].repeat(len(ids), axis=0))
        friction[..., 0] = drawn.friction[:, None]
        self._friction[ids] = friction
        gain = np.array(model.actuator_gainprm[None].repeat(len(ids), axis=0))
        bias = np.array(model.actuator_biasprm[None].repeat(len(ids), axis=0))
        gain[..., 0] *= drawn.kp[:, None]
        bias[..., 1] *= drawn.kp[:, None]
        bias[..., 2] *= drawn.kd[:, None]
        self._gain[ids], self._bias[ids] = gain, bias
        self._gravity[ids] = randomize.gravity(drawn.slope_axis)
        self.slope_axis[ids] = drawn.slope_axis
        rotvec = np.concatenate([drawn.slope_axis, np.zeros((len(ids), 1))], axis=1)
        self.slope_quat[ids] = geometry.quat_from_rotvec(rotvec)
        self.delay[ids] = drawn.delay
        self.dynamics_factors[ids] = np.stack([drawn.friction, drawn.kp, drawn.kd], axis=-1)
        self._period[ids] = drawn.period
        self._set_motors(ids, drawn)
        self._batch.set_const(ids)

    def _set_motors(self, ids: NDArray[np.intp], drawn: randomize.Dynamics) -> None:
        armature, damping, self._limit[ids] = drawn.motors()
        self._armature[ids, 6:] = armature[:, None]
        self._damping[ids, 6:] = damping[:, None]
        self._torque_range[ids, :, 0] = -self._limit[ids]
        self._torque_range[ids, :, 1] = self._limit[ids]

    def reset(
        self, ids: NDArray[np.intp], qpos: Array, qvel: Array, target: Array | None = None
    ) -> None:
        """Put simulations `ids` (n,) at qpos (n, 19), qvel (n, 18), holding `target` (n, 12)."""
        self.qpos[ids] = qpos
        self.qvel[ids] = qvel
        self._warmstart[ids] = 0.0
        self.target[ids] = qpos[:, 7:19] if target is None else target

    def push(self, ids: NDArray[np.intp], delta_lin_vel_w: Array) -> None:
        """Kick the trunks of simulations `ids` (n,) by (n, 3) m/s."""
        self.qvel[ids, :3] += delta_lin_vel_w

    def step(self, target: Array) -> None:
        """One control period with new PD targets (N, 12), each late by its own delay."""
        steps = self.config.decimation
        jitter = 1.0 + self._period * self.rng.uniform(-1.0, 1.0, len(self._period))
        self._timestep[...] = (self.dt * jitter).reshape(self._timestep.shape)
        controls = delayed_controls(self.target, target, self.delay, self.dt, steps)
        for k in range(0, steps, self.config.motor_every):
            self._limit_torque()
            part = np.ascontiguousarray(controls[:, k : k + self.config.motor_every])
            self._batch.rollout(part.shape[1], part, int(mujoco.mjtState.mjSTATE_CTRL), record=())
        self.target = np.array(target)

    def _limit_torque(self) -> None:
        """Each motor's torque range at its present speed, held for `motor_every` substeps.

        Only robots with a joint fast enough are touched; most never are.
        """
        motor = self.config.motor
        fast = np.abs(self.joint_vel).max(axis=-1) > motor.full_below(self._limit)
        ids = np.flatnonzero(fast | self._slowed)
        self._slowed = fast
        if len(ids):
            limit = self._limit[ids]
            for side, torque in enumerate(motor.torques(self.joint_vel[ids])):
                self._torque_range[ids, :, side] = np.clip(torque, -limit, limit)


def training_model(config: BatchConfig, dt: float) -> mujoco.MjModel:
    """The A1 on a plane without what training never reads: sensors, and contacts not asked for."""
    spec = build_spec(
        ModelConfig(
            timestep=dt, self_collision=config.self_collision, leg_contact=config.leg_contact
        )
    )
    for sensor in list(spec.sensors):
        spec.delete(sensor)
    return spec.compile()
