"""The environment: re-anchoring, ends, truncation, evaluation, and the deployed path beside it."""

import itertools
from dataclasses import replace

import numpy as np
import pytest

from studio import geometry
from studio.control.observation import ObservationConfig
from studio.control.policy import Policy, manifest_of
from studio.reference.library import TASKS, task_names
from studio.reference.realize import realize
from studio.rl.bank import MotionBank, build_bank, warp
from studio.rl.curriculum import Curriculum, Rung, stages
from studio.rl.env import ImitationEnv
from studio.rl.env_config import EnvConfig
from studio.rl.noise import NoiseConfig
from studio.rl.rollouts import evaluation_env, pd_playback, run_episodes, stand_still
from studio.robot import a1
from studio.robot.pose import ReferencePose, RobotState

QUIET = NoiseConfig(joint_sigma=(0.0, 0.0), repeat=(0.0, 0.0), encoder=0.0, gyro=0.0)


@pytest.fixture(scope="module")
def stand() -> MotionBank:
    return build_bank("stand", per_task=1, seconds=2.0, difficulties=(0.4, 1.0))


@pytest.fixture(scope="module")
def walk() -> MotionBank:
    return build_bank("walk", per_task=1, seconds=2.0, difficulties=(0.4,))


def nominal(bank: MotionBank, n: int = 8, seed: int = 0, **settings: object) -> ImitationEnv:
    stage = Rung(tasks=bank.tasks, difficulty=1.0, randomisation=0.0)
    config = EnvConfig(num_envs=n, threads=1, noise=QUIET, init_joint_noise=0.0, **settings)  # type: ignore[arg-type]
    return ImitationEnv(config, bank, seed=seed, curriculum=Curriculum(ladder=[stage]))


def test_reference_state_initialisation_starts_on_the_reference(walk: MotionBank) -> None:
    env = nominal(walk)
    env.reset()
    f = env.begin
    assert len(set(f)) > 1
    assert env.world.joint_pos == pytest.approx(walk.joint_pos[env.motion, f])
    assert env.world.joint_vel == pytest.approx(walk.joint_vel[env.motion, f])
    quat = walk.base_quat[env.motion, f]
    assert geometry.quat_angle(env.world.base_quat, quat) == pytest.approx(np.zeros(8), abs=1e-6)


def test_standing_playback_tracks_and_nobody_falls(stand: MotionBank) -> None:
    env = nominal(stand)
    env.reset()
    for _ in range(25):
        observation, reward, terminated, _, _ = env.step(np.zeros((8, 12)))
        assert not terminated.any()
    assert observation.shape == (8, 176)
    assert np.isfinite(observation).all()
    assert np.all((reward > 0.5) & (reward <= 1.0))
    assert env.metrics["foot_error"].max() < 0.05


def test_anchor_follows_the_reference_and_leaks_to_the_robot(walk: MotionBank) -> None:
    env = nominal(walk)
    env.reset()
    gap = np.array([0.3, 0.0])
    env.anchor_pos = env.world.base_pos[:, :2] + gap
    env.anchor_yaw = np.array(env.yaw)
    before = env.anchor_pos - env.world.base_pos[:, :2]
    env._measure()
    after = env.anchor_pos - env.world.base_pos[:, :2]
    assert after == pytest.approx(before * (1.0 - 1.0 / 30.0 / 0.5))


def test_trunk_on_the_floor_ends_an_episode_and_begins_another(stand: MotionBank) -> None:
    env = nominal(stand)
    env.reset()
    env.world.qpos[2, 2] = 0.055  # lying on its trunk, legs in the air
    env.world.qpos[2, 7:] = np.tile([0.0, np.pi, -1.0], 4)
    env.world.qpos[5, 3:7] = geometry.quat_from_rpy([np.pi / 2, 0.0, 0.0])
    _, _, terminated, truncated, extras = env.step(np.zeros((8, 12)))
    assert list(np.flatnonzero(terminated)) == [2, 5]
    assert not truncated.any()
    assert list(extras["episode_tracked_ratio"]) == [0.0, 0.0]
    assert env.world.base_pos[[2, 5], 2].min() > 0.15


def test_links_through_links_end_an_episode_within_half_a_second(stand: MotionBank) -> None:
    env = nominal(stand, n=2)
    env.reset()
    crossed = a1.STAND_JOINT_POS.copy()
    crossed[[0, 3]] = 0.8, -0.8  # both front legs under the trunk, through each other
    ended = False
    for _ in range(16):
        env.world.qpos[1, 7:] = crossed
        ended |= bool(env.step(np.zeros((2, 12)), np.tile(crossed, (2, 1)))[2][1])
    assert ended


def test_time_limit_truncates_and_hands_over_the_last_observation(stand: MotionBank) -> None:
    env = nominal(stand)
    env.reset()
    env.frame[3] = stand.frames - 1
    observation, _, terminated, truncated, extras = env.step(np.zeros((8, 12)))
    assert truncated[3]
    assert not terminated[3]
    assert list(extras["final_ids"]) == [3]
    last, first = extras["final_observation"][0], observation[3]
    # What it saw last ends a history of four frames; the new episode's history is one frame.
    assert np.array_equal(first[:17], first[51:68])
    assert not np.array_equal(last[:17], last[51:68])


def test_the_same_seed_gives_the_same_episode(walk: MotionBank) -> None:
    runs = []
    for _ in range(2):
        stage = Rung(tasks=walk.tasks, difficulty=1.0, randomisation=1.0)
        env = ImitationEnv(
            EnvConfig(num_envs=6, threads=1), walk, seed=4, curriculum=Curriculum(ladder=[stage])
        )
        env.reset()
        for _ in range(12):
            out = env.step(np.zeros((6, 12)))
        runs.append((out[0], out[1]))
    assert np.array_equal(runs[0][0], runs[1][0])
    assert np.array_equal(runs[0][1], runs[1][1])


def test_evaluation_meets_every_controller_with_the_same_references(stand: MotionBank) -> None:
    noisy = []
    for act in (stand_still, pd_playback):
        env = evaluation_env(stand, 6, seed=1, threads=1)
        env.reset()
        for _ in range(20):
            command = act(env)
            env.step(command.action, command.target)
        noisy.append((np.array(env.noisy_joint_pos), np.array(env.world.delay)))
    assert np.array_equal(noisy[0][0], noisy[1][0])
    assert np.array_equal(noisy[0][1], noisy[1][1])


def test_episode_figures_tell_playback_from_standing_still(stand: MotionBank) -> None:
    figures = {
        act.__name__: run_episodes(
            evaluation_env(stand, 12, 0, randomisation=0.0, noise=0.0, threads=1), act
        )
        for act in (stand_still, pd_playback)
    }
    assert np.all(figures["pd_playback"]["success_time"] == 1.0)
    still, playback = (figures[k]["joint_ms"].mean() for k in ("stand_still", "pd_playback"))
    assert playback < 0.5 * still
    assert np.all(figures["pd_playback"]["tracked_time"] <= 1.0)


def test_warp_plays_a_motion_faster() -> None:
    name = task_names("walk")[0]
    motion = realize(TASKS[name].sample(np.random.default_rng(0), 4.0))
    fast = warp(motion, 1.25, 90)
    # frame 40 of the fast one is frame 50 of the motion
    assert fast.joint_pos[40] == pytest.approx(motion.joint_pos[50])
    assert fast.base_pos[40] == pytest.approx(motion.base_pos[50])


def test_curriculum_climbs_by_task_then_range_then_randomisation() -> None:
    ladder = stages(("a", "b"))
    assert [s.tasks for s in ladder[:2]] == [("a",), ("a", "b")]
    assert [s.difficulty for s in ladder] == [0.4, 0.4, 0.7, 1.0, 1.0, 1.0, 1.0]
    assert [s.randomisation for s in ladder] == [0.0, 0.0, 0.0, 0.0, 0.34, 0.67, 1.0]


def test_curriculum_waits_for_the_gate_and_counts_only_its_own_stage() -> None:
    curriculum = Curriculum(ladder=stages(("a",)), gate=0.8, window=4, patience=100)
    assert not curriculum.record(np.array([1.0, 1.0, 1.0]))  # the window is not full
    assert not curriculum.record(np.array([0.0]))  # 0.75
    assert not curriculum.record(np.array([1.0]))  # the last four: 1, 1, 0, 1
    assert curriculum.record(np.array([1.0, 1.0, 1.0]))
    assert curriculum.level == 1


def test_curriculum_gives_up_waiting_after_its_patience() -> None:
    curriculum = Curriculum(ladder=stages(("a",)), gate=0.8, window=4, patience=10)
    assert not curriculum.record(np.zeros(9))
    assert curriculum.record(np.zeros(1))


def test_curriculum_state_survives_a_checkpoint() -> None:
    curriculum = Curriculum(ladder=stages(("a", "b")), window=2)
    curriculum.record(np.ones(2))
    other = Curriculum(ladder=stages(("a", "b")), window=2)
    other.load(curriculum.state())
    assert other.stage == curriculum.stage


def random_policy(env: ImitationEnv) -> Policy:
    rng = np.random.default_rng(0)
    sizes = (env.config.observation.dim, 32, 32, 12)
    tensors = {"mean": rng.standard_normal(sizes[0]), "std": rng.uniform(0.5, 2.0, sizes[0])}
    for i, (a, b) in enumerate(itertools.pairwise(sizes)):
        tensors[f"weight_{i}"] = 0.3 * rng.standard_normal((b, a)) / np.sqrt(a)
        tensors[f"bias_{i}"] = 0.1 * rng.standard_normal(b)
    config = env.config
    manifest = manifest_of("walk", config.observation, config.action, env.level, env.neutral)
    return Policy({k: v.astype(np.float32) for k, v in tensors.items()}, manifest)


def test_the_deployed_path_gives_the_actions_of_training(walk: MotionBank) -> None:
    env = nominal(walk, n=1)
    observation = env.reset()
    policy = random_policy(env)
    bank, w = walk, env.world
    worst = 0.0
    for step in range(25):
        m, f = env.motion[0], env.frame[0]
        reference = ReferencePose(
            base_pos=bank.base_pos[m, f],
            base_quat=bank.base_quat[m, f],
            joint_pos=bank.joint_pos[m, f],
            foot_contact=bank.contact[m, f],
            base_lin_vel_w=bank.lin_vel_w[m, f],
            base_ang_vel_b=bank.ang_vel_b[m, f],
            joint_vel=bank.joint_vel[m, f],
        )
        robot = RobotState(
            base_pos=np.array(w.base_pos[0]),
            base_quat=np.array(w.base_quat[0]),
            joint_pos=np.array(w.joint_pos[0]),
            foot_contact=np.zeros(4),
            t=step / 30.0,
            base_lin_vel_w=np.array(w.base_lin_vel_w[0]),
            base_ang_vel_b=np.array(w.base_ang_vel_b[0]),
            joint_vel=np.array(w.joint_vel[0]),
            foot_pos_w=np.zeros((4, 3)),
            torque=np.zeros(12),
        )
        if step == 0:
            policy.reset(reference, robot)
        target = policy.action(reference, robot)
        action = policy.network(observation).astype(np.float64)
        trained = np.clip(
            env.noisy_joint_pos + 0.25 * np.clip(action, -4.0, 4.0), a1.JOINT_LOWER, a1.JOINT_UPPER
        )
        worst = max(worst, float(np.abs(target - trained).max()))
        observation, _, terminated, truncated, _ = env.step(action)
        if terminated.any() or truncated.any():
            break
    assert step > 5
    assert worst < 1e-5


def test_of_the_ended_only_the_truncated_are_for_bootstrapping(stand: MotionBank) -> None:
    env = nominal(stand)
    env.reset()
    env.frame[3] = stand.frames - 1
    env.world.qpos[5, 3:7] = geometry.quat_from_rpy([np.pi / 2, 0.0, 0.0])
    _, _, terminated, truncated, extras = env.step(np.zeros((8, 12)))
    assert (list(np.flatnonzero(truncated)), list(np.flatnonzero(terminated))) == ([3], [5])
    assert list(extras["ended_ids"]) == [3, 5]
    assert list(extras["final_ids"]) == [3]
    assert np.array_equal(extras["final_observation"], extras["ended_observation"][:1])
    assert extras["ended_observation"][1, 51 + 12] > np.radians(80.0)  # the roll it fell with
    assert len(extras["final_privileged"]) == 1


def test_a_robot_led_astray_knows_how_far_off_its_way_it_begins(walk: MotionBank) -> None:
    observation = ObservationConfig(heading_gain=1.0)
    config = EnvConfig(num_envs=8, threads=1, observation=observation, init_heading=0.3)
    env = ImitationEnv(config, walk, seed=0)
    env.reset()
    assert np.abs(env.history.heading_error).max() > 0.05
    np.testing.assert_allclose(
        geometry.wrap_angle(env.anchor_yaw - env.yaw), env.history.heading_error, atol=0.02
    )
    judged = ImitationEnv(replace(config, evaluation=True), walk, seed=0)
    judged.reset()
    assert not judged.history.heading_error.any()
