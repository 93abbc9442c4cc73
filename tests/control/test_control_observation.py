"""What the policy sees: frames, histories, mirror, action and noise."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from studio import geometry
from studio.control import symmetry
from studio.control.action import ActionConfig, clip_action, pd_target
from studio.control.observation import History, ObservationConfig
from studio.control.observation_frame import (
    heading_of,
    level_quat,
    reference_frame,
    roll_pitch,
    sensor_frame,
)
from studio.control.policy import Network, Symmetric
from studio.errors import StudioError
from studio.reference.intent import StateName
from studio.reference.stances import NEUTRAL
from studio.rl import noise, termination
from studio.robot import a1
from studio.robot.a1 import MIRROR_JOINT, MIRROR_SIGN

LEVEL = geometry.IDENTITY_QUAT


def mirror_joints(x: np.ndarray) -> np.ndarray:
    return MIRROR_SIGN * x[..., MIRROR_JOINT]


def test_sensor_frame_holds_joints_tilt_and_rates_in_that_order() -> None:
    quat = geometry.quat_from_rpy([0.1, -0.2, 2.0])[None]
    z = sensor_frame(np.arange(12.0)[None], quat, np.array([[1.0, 2.0, 3.0]]), LEVEL)
    assert z[0, :12] == pytest.approx(np.arange(12.0))
    assert z[0, 12:] == pytest.approx([0.1, -0.2, 1.0, 2.0, 3.0])


def test_the_papers_sensor_frame_has_sixteen_entries() -> None:
    z = sensor_frame(np.zeros((2, 12)), np.tile(LEVEL, (2, 1)), np.zeros((2, 3)), LEVEL, False)
    assert z.shape == (2, 16)


def test_neutral_sitting_is_level_in_the_frame_of_sitting() -> None:
    sit = NEUTRAL["sit"]
    level = np.array(level_quat("sit"))
    turned = geometry.quat_mul(geometry.quat_from_rpy([0.0, 0.0, 1.0]), sit.base_quat)
    z = sensor_frame(sit.joint_pos[None], turned[None], np.zeros((1, 3)), level)
    assert z[0, 12:] == pytest.approx(np.zeros(5), abs=1e-9)


def test_reference_velocity_is_in_its_own_heading_frame() -> None:
    quat = geometry.quat_from_rpy([0.0, 0.0, np.pi / 2])[None]  # faces +y
    p = reference_frame(
        np.zeros((1, 12)),
        np.array([0.3]),
        quat,
        np.array([[-0.2, 0.5, 0.0]]),
        np.array([[0.0, 0.0, 0.7]]),
        LEVEL,
    )
    # height, roll, pitch, yaw rate, 0.5 m/s ahead, 0.2 m/s to the left
    assert p[0, 12:] == pytest.approx([0.3, 0.0, 0.0, 0.7, 0.5, 0.2])


def test_observation_is_oldest_first_and_resets_per_robot() -> None:
    config = ObservationConfig()
    history = History(2, config)
    history.reset(slice(None), np.zeros((2, 17)), np.zeros((2, 18)))
    for k in range(1, 4):
        history.push_action(np.full((2, 12), 10.0 + k))
        history.push(np.full((2, 17), float(k)), np.full((2, 18), 20.0 + k))
    o = history.observation()
    assert o.shape == (2, config.dim) == (2, 176)
    assert list(o[0, [0, 17, 34, 51]]) == [0.0, 1.0, 2.0, 3.0]
    assert list(o[0, [68, 80, 92]]) == [11.0, 12.0, 13.0]
    assert list(o[0, [104, 122, 140, 158]]) == [0.0, 21.0, 22.0, 23.0]
    history.reset(np.array([1]), np.full((1, 17), 7.0), np.full((1, 18), 8.0))
    assert np.array_equal(history.observation()[0], o[0])
    assert set(history.observation()[1]) == {7.0, 0.0, 8.0}


def test_manifest_blocks_add_up_to_the_observation() -> None:
    for yaw_rate in (True, False):
        config = ObservationConfig(yaw_rate=yaw_rate)
        assert sum(int(str(b["size"])) for b in config.manifest()) == config.dim


def test_zero_action_is_the_reference_and_targets_keep_the_limits() -> None:
    reference = a1.STAND_JOINT_POS[None]
    config = ActionConfig()
    assert pd_target(np.zeros((1, 12)), reference, reference, config) == pytest.approx(reference)
    far = pd_target(clip_action(np.full((1, 12), 99.0)), reference, reference, config)
    assert np.all(far <= a1.JOINT_UPPER)
    assert far[0, 1] == pytest.approx(a1.STAND_JOINT_POS[1] + 1.0)  # 4 units of 0.25 rad


def test_absolute_action_is_about_the_neutral_stance() -> None:
    neutral, reference = a1.STAND_JOINT_POS[None], a1.STAND_JOINT_POS[None] + 0.3
    out = pd_target(np.full((1, 12), 0.4), reference, neutral, ActionConfig(mode="absolute"))
    assert out == pytest.approx(neutral + 0.1)


def test_unknown_action_mode_names_the_known_ones() -> None:
    with pytest.raises(StudioError, match="absolute, residual"):
        pd_target(np.zeros((1, 12)), np.zeros(12), np.zeros(12), ActionConfig(mode="x"))  # type: ignore[arg-type]


@pytest.mark.parametrize("yaw_rate", [True, False])
def test_mirror_twice_is_identity(yaw_rate: bool) -> None:
    for index, sign in (
        symmetry.observation_mirror(ObservationConfig(yaw_rate=yaw_rate)),
        symmetry.privileged_mirror(),
        (MIRROR_JOINT, MIRROR_SIGN),
    ):
        x = np.random.default_rng(0).standard_normal(len(index))
        once = sign * x[index]
        assert (sign * once[index]) == pytest.approx(x)
        assert not np.allclose(once, x)


def test_mirrored_pose_is_seen_as_the_mirrored_observation() -> None:
    rng = np.random.default_rng(3)
    joints, rpy, gyro = rng.standard_normal((1, 12)), np.array([0.2, -0.1, 0.4]), rng.random((1, 3))
    z = sensor_frame(joints, geometry.quat_from_rpy(rpy)[None], gyro, LEVEL)
    # Across the x-z plane: roll and yaw turn over, and so do body rates about x and z.
    other = sensor_frame(
        mirror_joints(joints),
        geometry.quat_from_rpy(rpy * [-1.0, 1.0, -1.0])[None],
        gyro * [-1.0, 1.0, -1.0],
        LEVEL,
    )
    index, sign = symmetry.observation_mirror(ObservationConfig())
    assert (sign[:17] * z[0, index[:17]]) == pytest.approx(other[0])


@settings(deadline=None, max_examples=20)
@given(st.floats(0.01, 2.0), st.floats(0.05, 2.0))
def test_ou_noise_keeps_its_stationary_variance(sigma: float, tau: float) -> None:
    # var' = ρ² σ² + σ² (1 − ρ²) = σ²
    rng = np.random.default_rng(1)
    start = sigma * rng.standard_normal((20000, 1))
    after = noise.ou_step(start, np.array([[sigma]]), tau, 1 / 30, rng)
    assert after.std() == pytest.approx(sigma, rel=0.05)
    rho = np.exp(-(1 / 30) / tau)
    assert np.corrcoef(start[:, 0], after[:, 0])[0, 1] == pytest.approx(rho, abs=0.05)


def test_repeated_frames_come_at_their_share() -> None:
    config = noise.NoiseConfig(repeat=(0.3, 0.3))
    source = noise.ReferenceNoise(4000, config, np.random.default_rng(0))
    source.reset(np.arange(4000), np.zeros((4000, 18)))
    before = source.last
    after = source.step(np.zeros((4000, 18)))
    assert np.mean(np.all(before == after, axis=1)) == pytest.approx(0.3, abs=0.03)


def test_trunk_clearance_of_level_and_rolled_boxes() -> None:
    pos = np.array([[0.0, 0.0, 0.27], [0.0, 0.0, 0.2]])
    quat = np.stack([LEVEL, geometry.quat_from_rpy([np.pi / 2, 0.0, 0.0])])
    # level: 0.27 - 0.057; on its side: 0.2 - 0.097
    assert termination.trunk_clearance(pos, quat) == pytest.approx([0.213, 0.103])


def test_a_fall_is_measured_against_the_reference() -> None:
    sit = NEUTRAL["sit"]
    pose = sit.base_pos[None] + [0.0, 0.0, 0.05], sit.base_quat[None]
    assert not termination.fallen(*pose, sit.base_quat[None])
    assert termination.fallen(*pose, LEVEL[None])  # 70 degrees off a standing reference


@pytest.mark.parametrize("state", ["stand", "sit"])
def test_levelled_heading_and_tilt_agree_with_spatial(state: StateName) -> None:
    level = np.array(level_quat(state))
    rpy = np.random.default_rng(0).uniform(-0.7, 0.7, (20, 3))
    quat = geometry.quat_mul(geometry.quat_from_rpy(rpy), level)
    assert heading_of(quat, level) == pytest.approx(rpy[:, 2])
    levelled = geometry.quat_mul(quat, geometry.quat_conj(level))
    assert heading_of(quat, level) == pytest.approx(geometry.heading(levelled))
    assert roll_pitch(quat, level) == pytest.approx(rpy[:, :2])


def test_reference_yaw_rate_is_the_vertical_part_of_the_turning() -> None:
    quat = geometry.quat_from_rpy(np.random.default_rng(0).uniform(-1.0, 1.0, (5, 3)))
    rate = np.random.default_rng(1).standard_normal((5, 3))
    p = reference_frame(np.zeros((5, 12)), np.zeros(5), quat, np.zeros((5, 3)), rate, LEVEL)
    assert p[:, 15] == pytest.approx(geometry.quat_rotate(quat, rate)[:, 2])


def test_roll_pitch_agree_with_spatial() -> None:
    rpy = np.random.default_rng(0).uniform(-1.0, 1.0, (20, 3))
    assert roll_pitch(geometry.quat_from_rpy(rpy)) == pytest.approx(rpy[:, :2])


def test_a_symmetric_network_acts_in_the_mirror_as_its_mirror_image() -> None:
    rng = np.random.default_rng(0)
    config = ObservationConfig()
    tensors = {
        "mean": rng.standard_normal(config.dim),
        "std": rng.uniform(0.5, 2.0, config.dim),
        "weight_0": rng.standard_normal((16, config.dim)),
        "bias_0": rng.standard_normal(16),
        "weight_1": rng.standard_normal((12, 16)),
        "bias_1": rng.standard_normal(12),
    }
    network = Network({k: v.astype(np.float32) for k, v in tensors.items()})
    index, sign = symmetry.observation_mirror(config)
    seen = rng.standard_normal((3, config.dim)).astype(np.float32)
    mirrored = (seen[:, index] * sign).astype(np.float32)
    act = Symmetric(network, config)
    acted, alone = act(seen).astype(np.float64), network(seen).astype(np.float64)
    # Sums of 16 products in another order: some roundings of the largest output.
    atol = 32 * np.finfo(np.float32).eps * np.abs(alone).max()
    np.testing.assert_allclose(act(mirrored), mirror_joints(acted), atol=atol, rtol=0.0)
    assert np.abs(network(mirrored) - mirror_joints(alone)).max() > 0.1
