"""Rotations obey their axioms, single and batched."""

from functools import partial

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from studio import geometry
from studio.geometry import scalars
from studio.training import losses, mapper_net

settings.register_profile("spatial", max_examples=60, deadline=None)
settings.load_profile("spatial")

number = st.floats(-3.0, 3.0)
vectors = st.tuples(number, number, number).map(np.array)
quats = st.integers(0, 2**32 - 1).map(
    lambda seed: geometry.normalize(np.random.default_rng(seed).normal(size=4))
)


def same_rotation(a, b, tolerance: float = 1e-9) -> bool:
    return bool(np.all(geometry.quat_angle(a, b) < tolerance))


def scipy_rotation(q) -> Rotation:
    return Rotation.from_quat(np.roll(q, -1, axis=-1))  # SciPy keeps w last


@given(quats, quats, quats)
def test_products_associate_and_conjugates_invert(a, b, c):
    left = geometry.quat_mul(geometry.quat_mul(a, b), c)
    np.testing.assert_allclose(left, geometry.quat_mul(a, geometry.quat_mul(b, c)), atol=1e-12)
    np.testing.assert_allclose(
        geometry.quat_mul(a, geometry.quat_conj(a)), geometry.IDENTITY_QUAT, atol=1e-12
    )


@given(quats, quats, vectors)
def test_rotating_twice_is_rotating_by_the_product(a, b, v):
    twice = geometry.quat_rotate(a, geometry.quat_rotate(b, v))
    np.testing.assert_allclose(geometry.quat_rotate(geometry.quat_mul(a, b), v), twice, atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(twice), np.linalg.norm(v), atol=1e-12)
    np.testing.assert_allclose(
        geometry.quat_rotate_inverse(a, geometry.quat_rotate(a, v)), v, atol=1e-12
    )


@given(quats, vectors)
def test_matrices_agree_with_rotations_and_with_scipy(q, v):
    matrix = geometry.quat_to_matrix(q)
    np.testing.assert_allclose(matrix @ v, geometry.quat_rotate(q, v), atol=1e-12)
    np.testing.assert_allclose(matrix, scipy_rotation(q).as_matrix(), atol=1e-12)
    assert np.linalg.det(matrix) == pytest.approx(1.0)
    back = geometry.quat_from_matrix(matrix)
    assert back[0] >= 0.0
    np.testing.assert_allclose(back, geometry.quat_positive(q), atol=1e-9)


@pytest.mark.parametrize("axis", np.eye(3))
def test_half_turns_survive_the_matrix_where_w_vanishes(axis):
    q = geometry.quat_from_axis_angle(axis, np.pi)
    assert same_rotation(geometry.quat_from_matrix(geometry.quat_to_matrix(q)), q)


@given(quats)
def test_rotation_vectors_are_the_logarithm(q):
    r = geometry.quat_to_rotvec(q)
    assert np.linalg.norm(r) <= np.pi + 1e-9
    assert same_rotation(geometry.quat_from_rotvec(r), q)
    angle = np.linalg.norm(r)
    np.testing.assert_allclose(angle, scipy_rotation(q).magnitude(), atol=1e-9)


@given(vectors.map(lambda v: v * 1e-9))
def test_tiny_rotations_keep_their_direction(r):
    np.testing.assert_allclose(
        geometry.quat_to_rotvec(geometry.quat_from_rotvec(r)), r, rtol=1e-6, atol=1e-20
    )


@given(st.floats(-3.1, 3.1), st.floats(-1.5, 1.5), st.floats(-3.1, 3.1))
def test_roll_pitch_yaw_round_trip_and_are_scipy_s(roll, pitch, yaw):
    rpy = np.array([roll, pitch, yaw])
    q = geometry.quat_from_rpy(rpy)
    np.testing.assert_allclose(geometry.quat_to_rpy(q), rpy, atol=1e-7)
    expected = Rotation.from_euler("ZYX", rpy[::-1]).as_matrix()
    np.testing.assert_allclose(geometry.quat_to_matrix(q), expected, atol=1e-12)


@given(quats, quats)
def test_angle_is_symmetric_bounded_and_blind_to_sign(a, b):
    angle = geometry.quat_angle(a, b)
    assert 0.0 <= angle <= np.pi + 1e-9
    np.testing.assert_allclose(angle, geometry.quat_angle(b, a), atol=1e-9)
    np.testing.assert_allclose(angle, geometry.quat_angle(-a, b), atol=1e-9)
    np.testing.assert_allclose(np.cos(angle / 2), abs(np.dot(a, b)), atol=1e-9)


@given(quats, quats, st.floats(0.0, 1.0))
def test_slerp_moves_at_constant_angle(a, b, s):
    middle = geometry.quat_slerp(a, b, s)
    angle = geometry.quat_angle(a, b)
    np.testing.assert_allclose(geometry.quat_angle(a, middle), s * angle, atol=1e-7)
    np.testing.assert_allclose(geometry.quat_angle(middle, b), (1 - s) * angle, atol=1e-7)


@given(quats, vectors)
def test_the_difference_of_two_rotations_is_the_velocity_between_them(q, velocity):
    later = geometry.quat_mul(q, geometry.quat_from_rotvec(velocity * 0.1))
    found = geometry.ang_vel_b(np.stack([q, later]), 0.1)
    np.testing.assert_allclose(found[1], velocity, atol=1e-6)
    np.testing.assert_allclose(found[0], found[1])


@given(st.floats(-3.0, 3.0), st.floats(-1.2, 1.2), st.floats(-3.0, 3.0))
def test_turning_a_body_turns_its_heading_as_much(roll, pitch, yaw):
    q = geometry.quat_from_rpy(np.array([0.3 * roll, pitch, 0.0]))
    turned = geometry.quat_mul(geometry.quat_from_rpy(np.array([0.0, 0.0, yaw])), q)
    turn = geometry.wrap_angle(geometry.heading(turned) - geometry.heading(q))
    np.testing.assert_allclose(turn, geometry.wrap_angle(yaw), atol=1e-9)


@given(st.floats(-100.0, 100.0))
def test_wrapped_angles_are_the_same_angle_in_one_turn(angle):
    wrapped = float(geometry.wrap_angle(angle))
    assert -np.pi <= wrapped < np.pi
    np.testing.assert_allclose(np.sin(wrapped), np.sin(angle), atol=1e-9)


def test_everything_works_on_batches_as_on_singles():
    rng = np.random.default_rng(0)
    a, b = geometry.normalize(rng.normal(size=(2, 3, 5, 4)))
    v, s = rng.normal(size=(3, 5, 3)), rng.random((3, 5))
    cases = [
        (geometry.quat_mul, (a, b)),
        (geometry.quat_rotate, (a, v)),
        (geometry.quat_rotate_inverse, (a, v)),
        (geometry.quat_to_rotvec, (a,)),
        (geometry.quat_to_matrix, (a,)),
        (geometry.quat_to_rpy, (a,)),
        (geometry.quat_from_rotvec, (v,)),
        (geometry.quat_slerp, (a, b, s)),
        (geometry.quat_angle, (a, b)),
        (geometry.heading, (a,)),
        (geometry.heading_quat, (a,)),
        (geometry.up_in_body, (a,)),
    ]
    for function, args in cases:
        batch = function(*args)
        for i in np.ndindex(3, 5):
            one = function(*(x[i] for x in args))
            np.testing.assert_allclose(one, batch[i], atol=1e-12, err_msg=function.__name__)


@given(quats, quats, vectors)
def test_the_formulas_by_component_are_scipy_s(a, b, v):
    close = partial(np.testing.assert_allclose, atol=1e-12)
    product = np.roll((scipy_rotation(a) * scipy_rotation(b)).as_quat(), 1)
    close(geometry.quat_positive(scalars.mul(a, b)), geometry.quat_positive(product))
    turn = scipy_rotation(a)
    close(scalars.turn(a, v), turn.apply(v))
    close(scalars.rows(a), turn.as_matrix())
    close(scalars.rotate(scalars.rows(a), v), turn.apply(v))
    close(scalars.rotate_back(scalars.rows(a), v), turn.apply(v, inverse=True))
    close(scalars.turn(scalars.conj(a), v), turn.apply(v, inverse=True))
    close(scalars.turn(scalars.yaw(v[0]), v), Rotation.from_euler("Z", v[0]).apply(v))
    close(scalars.rows(scalars.from_rotvec(v)), Rotation.from_rotvec(v).as_matrix())
    close(scalars.rows(scalars.from_rotvec(scalars.rotvec(a))), turn.as_matrix())


def test_a_tensor_is_turned_and_multiplied_by_the_same_formulas():
    rng = np.random.default_rng(1)
    a, b = geometry.normalize(rng.normal(size=(2, 7, 4)))
    v = rng.normal(size=(7, 4, 3))
    product = mapper_net.quat_mul(torch.tensor(a), torch.tensor(b)).numpy()
    np.testing.assert_allclose(product, geometry.quat_mul(a, b), atol=1e-12)
    turned = losses.rotate(torch.tensor(a), torch.tensor(v)).numpy()
    np.testing.assert_allclose(turned, geometry.quat_rotate(a[:, None], v), atol=1e-12)


def test_first_velocity_repeats_the_second_and_one_frame_has_none():
    assert geometry.ang_vel_b(geometry.IDENTITY_QUAT[None], 0.1).tolist() == [[0.0, 0.0, 0.0]]


def test_up_in_the_body_is_the_last_row_of_the_rotation_matrix():
    quat = geometry.normalize(np.random.default_rng(5).normal(size=(20, 4)))
    up = geometry.up_in_body(quat)
    assert np.allclose(up, geometry.quat_to_matrix(quat)[:, 2], atol=1e-15)
    assert np.allclose(geometry.quat_rotate(quat, up), [0.0, 0.0, 1.0], atol=1e-12)
