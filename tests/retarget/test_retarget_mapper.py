"""The expert network: the numpy door equals its torch twin, and respects the joint limits."""

import numpy as np
import pytest
import torch

from studio import geometry
from studio.errors import StudioError
from studio.retarget.mapper import RATES, Mapper
from studio.robot import a1
from studio.training.mapper_net import MapperNet

WIDTH = 3 * 20


@pytest.fixture
def net() -> MapperNet:
    rng = np.random.default_rng(0)
    neutral = geometry.quat_from_rpy([0.1, -1.2, 0.0])
    net = MapperNet(
        rng.normal(size=WIDTH), rng.uniform(0.5, 2.0, WIDTH), rng.uniform(0.1, 9.0, 36), neutral
    )
    with torch.no_grad():
        for p in net.parameters():  # far from the careful initialisation: bend every layer
            p.add_(0.02 * torch.randn(p.shape, generator=torch.Generator().manual_seed(1)))
    return net


def test_numpy_inference_equals_torch(net: MapperNet):
    x = np.random.default_rng(1).normal(scale=3.0, size=(64, WIDTH))
    mapper = Mapper.from_tensors(net.export())
    with torch.no_grad():
        motion, contact = net(net.normalize(torch.tensor(x, dtype=torch.float32)))
    for i in range(len(x)):
        mapped = mapper(x[i])
        np.testing.assert_allclose(mapped.joint_pos, motion.joint_pos[i].numpy(), atol=1e-5)
        np.testing.assert_allclose(mapped.base_quat, motion.quat[i].numpy(), atol=1e-5)
        np.testing.assert_allclose(mapped.contact_prob, contact[i].numpy(), atol=1e-5)
        lin_acc = mapped.rates[RATES["base_lin_acc"]]
        np.testing.assert_allclose(lin_acc, motion.lin_acc[i].numpy(), rtol=1e-4, atol=1e-4)


def test_joint_angles_stay_inside_the_limits_for_wild_input(net: MapperNet):
    mapper = Mapper.from_tensors(net.export())
    for scale in (1e3, 1e9):
        mapped = mapper(np.random.default_rng(2).normal(scale=scale, size=WIDTH))
        assert np.all(mapped.joint_pos >= a1.JOINT_LOWER - 1e-9)
        assert np.all(mapped.joint_pos <= a1.JOINT_UPPER + 1e-9)
        assert abs(np.linalg.norm(mapped.base_quat) - 1.0) < 1e-6


def test_contact_does_not_see_acceleration(net: MapperNet):
    mapper = Mapper.from_tensors(net.export())
    x = np.random.default_rng(3).normal(size=WIDTH)
    other = x.copy()
    other[2 * WIDTH // 3 :] += 1.0
    np.testing.assert_array_equal(mapper(x).contact_prob, mapper(other).contact_prob)
    assert np.any(mapper(x).joint_pos != mapper(other).joint_pos)


def test_an_untrained_network_means_the_neutral_trunk():
    neutral = geometry.quat_from_rpy([0.0, -1.2, 0.0])
    net = MapperNet(np.zeros(WIDTH), np.ones(WIDTH), np.ones(36), neutral)
    mapped = Mapper.from_tensors(net.export())(np.zeros(WIDTH))
    np.testing.assert_allclose(mapped.base_quat, neutral, atol=1e-6)


def test_a_file_without_the_network_says_how_to_train():
    with pytest.raises(StudioError, match="train mapper"):
        Mapper.from_tensors({})
