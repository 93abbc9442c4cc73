"""A controller over many simulated episodes → one row of figures per episode."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from studio import geometry, metrics
from studio.control.policy import Policy
from studio.rl.bank import MotionBank
from studio.rl.curriculum import Curriculum, Rung
from studio.rl.env import ImitationEnv
from studio.rl.env_config import EnvConfig
from studio.robot import a1, kinematics

Array = NDArray[np.float64]
MAX_LAG = 10
"""Control periods up to which a lag behind the reference is looked for."""


@dataclass(frozen=True, kw_only=True)
class Sent:
    """What a controller sends: action (N, 12), or instead a PD target (N, 12) rad."""

    action: Array
    target: Array | None = None


Act = Callable[[ImitationEnv], Sent]


def stand_still(env: ImitationEnv) -> Sent:
    """The neutral pose, whatever is asked."""
    zero = np.zeros((env.num_envs, 12))
    return Sent(action=zero, target=np.broadcast_to(env.neutral, zero.shape))


def pd_playback(env: ImitationEnv) -> Sent:
    """The (noisy) reference straight to the PD."""
    zero = np.zeros((env.num_envs, 12))
    return Sent(action=zero, target=env.noisy_joint_pos)


def policy_of(policy: Policy) -> Act:
    """The network on the environment's own observations: the training path."""

    def act(env: ImitationEnv) -> Sent:
        action = policy.network(env.observation())
        return Sent(action=action.astype(np.float64))

    return act


def evaluation_env(
    bank: MotionBank,
    num: int,
    seed: int,
    *,
    randomisation: float = 1.0,
    noise: float = 1.0,
    threads: int = 0,
    settings: EnvConfig | None = None,
) -> ImitationEnv:
    """`num` episodes of the bank's motions from their first frame, dynamics from Table I.

    randomisation, noise: shares of the ranges and spreads of training.
    """
    stage = Rung(
        tasks=bank.tasks, difficulty=float(bank.difficulty.max()), randomisation=randomisation
    )
    config = replace(
        settings or EnvConfig(),
        num_envs=num,
        threads=threads,
        evaluation=True,
        noise_scale=noise,
    )
    curriculum = Curriculum(ladder=[stage])
    return ImitationEnv(config, bank, seed=seed, curriculum=curriculum)


def run_episodes(env: ImitationEnv, act: Act) -> dict[str, Array]:
    """Figures (N,) of one episode per robot, over the time until its fall.

    success_time, tracked_time: shares of the whole episode. joint_ms: mean squared joint error,
    rad². foot_error, height_error (m), tilt_error (rad), velocity_error (m/s), yaw_rate_error
    (rad/s): means. drift: m between the ways of robot and reference, over the reference's path
    length `path`. skate: m/s of feet on the floor. jerk: rad/s³ RMS. saturation: share of joints
    at the torque limit. lag: s by which the joints follow the reference best.
    """
    env.reset()
    n, steps = env.num_envs, env.bank.frames - 1
    alive = np.ones(n, dtype=bool)
    sums: dict[str, Array] = {}
    joints = np.zeros((steps, n, 12), dtype=np.float32)
    fallen = np.zeros((steps, n), dtype=bool)
    foot_error, tilt_error = np.zeros((steps, n)), np.zeros((steps, n))
    feet = np.zeros((steps + 1, n, 4, 3))
    feet[0] = _feet_w(env)
    start_pos, start_yaw = np.array(env.world.base_pos[:, :2]), np.array(env.yaw)
    end_pos = np.array(start_pos)
    for step in range(steps):
        command = act(env)
        _, _, fallen[step], _, _ = env.step(command.action, command.target)
        alive &= ~fallen[step]
        feet[step + 1] = _feet_w(env)
        foot_error[step], tilt_error[step] = env.metrics["foot_error"], env.metrics["tilt_error"]
        saturated = np.abs(env.world.torque) > 0.99 * a1.TORQUE_LIMIT
        now = {**env.metrics, "saturation": np.mean(saturated, axis=-1)}
        for name, value in now.items():
            sums[name] = sums.get(name, np.zeros(n)) + np.where(alive, value, 0.0)
        joints[step] = env.world.joint_pos
        end_pos = np.where(alive[:, None], env.world.base_pos[:, :2], end_pos)
    success = metrics.success_time_ratio(fallen)
    lifetime = np.rint(success * steps).astype(int)
    life = np.maximum(lifetime, 1.0)
    out = {
        "success_time": success,
        "tracked_time": metrics.tracked_time_ratio(fallen, foot_error, tilt_error),
        "joint_ms": sums["joint_sq"] / life,
        "skate": _skate(feet, lifetime),
    }
    for name in (
        "foot_error",
        "tilt_error",
        "height_error",
        "velocity_error",
        "yaw_rate_error",
        "saturation",
    ):
        out[name] = sums[name] / life
    out |= _way(env, start_pos, start_yaw, end_pos, lifetime)
    out |= _smoothness(env, joints, lifetime)
    return out


def _feet_w(env: ImitationEnv) -> Array:
    return kinematics.foot_pos_w(env.world.base_pos, env.world.base_quat, env.world.joint_pos)


def _skate(feet: Array, life: NDArray[np.intp]) -> Array:
    """(N,) m/s of the feet (steps + 1, N, 4, 3) that lie on the floor, while a robot is up."""
    down = feet[..., 2] < a1.FOOT_RADIUS + 0.005
    return np.array(
        [
            metrics.foot_skate_m_s(feet[: k + 1, i], down[: k + 1, i], a1.CONTROL_DT)
            for i, k in enumerate(life)
        ]
    )


def _way(
    env: ImitationEnv, start: Array, yaw: Array, end: Array, life: NDArray[np.intp]
) -> dict[str, Array]:
    """Drift between robot and reference over the time alive, and the reference's path length."""
    bank, m = env.bank, env.motion
    last = np.minimum(life, bank.frames - 1)
    moved = bank.base_pos[m, last, :2] - bank.base_pos[m, 0, :2]
    asked = geometry.turn_xy(moved, yaw - bank.yaw[m, 0])
    path = np.array([metrics.distance_m(bank.base_pos[i, : k + 1]) for i, k in zip(m, last)])
    return {"drift": np.linalg.norm(end - start - asked, axis=-1), "path": path}


def _smoothness(env: ImitationEnv, joints: NDArray, life: NDArray[np.intp]) -> dict[str, Array]:
    """RMS jerk of the joints, and the lag at which they match the reference best."""
    n = env.num_envs
    lag, jerk = np.zeros(n), np.zeros(n)
    for i in range(n):
        k = max(int(life[i]), MAX_LAG + 4)
        ours = joints[:k, i]
        asked = env.bank.joint_pos[env.motion[i], 1 : k + 1]
        lag[i] = metrics.lag_periods(ours, asked, MAX_LAG) * a1.CONTROL_DT
        jerk[i] = metrics.rms_jerk(ours, a1.CONTROL_DT)
    return {"lag": lag, "jerk": jerk}
