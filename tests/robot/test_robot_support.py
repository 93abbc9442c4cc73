"""The support polygon and the distance to it, by hand and against each other."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import ArrayLike, NDArray

from studio.robot import kinematics

Array = NDArray[np.float64]
SQUARE = np.array([[1.0, -1.0], [1.0, 1.0], [-1.0, -1.0], [-1.0, 1.0]])


def support_polygon(points_xy: ArrayLike, contact: ArrayLike) -> Array:
    """Convex hull (M, 2) m, counter-clockwise, of the points (N, 2) whose contact (N,) > 0.5.

    Fewer than three corners (a segment, a point, nothing) are returned as they are.
    """
    points = np.asarray(points_xy, dtype=np.float64)[np.asarray(contact) > 0.5]
    ordered = sorted(set(map(tuple, points.tolist())))
    if len(ordered) < 3:
        return np.array(ordered).reshape(-1, 2)

    def half(sequence: list[tuple[float, ...]]) -> list[tuple[float, ...]]:
        chain: list[tuple[float, ...]] = []
        for p in sequence:
            while len(chain) >= 2 and _turn(chain[-2], chain[-1], p) <= 0.0:
                chain.pop()
            chain.append(p)
        return chain[:-1]

    return np.array(half(ordered) + half(ordered[::-1]))


def _turn(a: tuple[float, ...], b: tuple[float, ...], c: tuple[float, ...]) -> float:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def polygon_distance(point_xy: ArrayLike, polygon: ArrayLike) -> Array:
    """Distance (...) m from points (..., 2) to a convex polygon (M, 2): 0 inside, inf if empty."""
    point, polygon = np.asarray(point_xy, dtype=np.float64), np.asarray(polygon, dtype=np.float64)
    if len(polygon) == 0:
        return np.full(point.shape[:-1], np.inf)
    following = np.roll(polygon, -1, axis=0)
    gap = _segment_gap(point[..., None, :], polygon, following)
    nearest = np.min(gap, axis=-1)
    if len(polygon) < 3:
        return nearest
    edge, to_point = following - polygon, point[..., None, :] - polygon
    inside = np.all(edge[:, 0] * to_point[..., 1] - edge[:, 1] * to_point[..., 0] >= 0.0, axis=-1)
    return np.where(inside, 0.0, nearest)


def _segment_gap(p: Array, a: Array, b: Array) -> Array:
    d = b - a
    along = np.sum((p - a) * d, axis=-1) / np.maximum(np.sum(d * d, axis=-1), 1e-18)
    along = np.clip(along, 0.0, 1.0)
    return np.linalg.norm(p - a - along[..., None] * d, axis=-1)


def test_four_feet_support_a_counter_clockwise_square():
    polygon = support_polygon(SQUARE, np.ones(4))
    assert len(polygon) == 4
    x, y = polygon.T
    # shoelace: 1/2 sum (x_i y_i+1 - x_i+1 y_i) = +4
    assert 0.5 * np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y) == 4.0


def test_distances_to_the_square_are_what_a_ruler_says():
    polygon = support_polygon(SQUARE, np.ones(4))
    points = np.array([[0.0, 0.0], [0.9, 0.9], [3.0, 0.0], [4.0, 5.0]])
    # inside, inside, 3 - 1, corner (1, 1): 3-4-5
    np.testing.assert_allclose(polygon_distance(points, polygon), [0, 0, 2, 5])


def test_three_feet_leave_out_the_lifted_corner():
    contact = np.array([0.0, 1.0, 1.0, 1.0])
    # the hull's edge joins (1, 1) and (-1, -1); (1, -1) is sqrt(2) from it
    assert np.isclose(kinematics.support_distance([1.0, -1.0], SQUARE, contact), np.sqrt(2.0))


def test_two_feet_are_a_segment_one_is_a_point_none_is_infinitely_far():
    two = np.array([1.0, 0.0, 0.0, 1.0])  # a trot's diagonal: (1, -1) to (-1, 1)
    assert np.isclose(kinematics.support_distance([1.0, 1.0], SQUARE, two), np.sqrt(2.0))
    one = np.array([1.0, 0.0, 0.0, 0.0])
    assert kinematics.support_distance([1.0, 2.0], SQUARE, one) == 3.0
    assert kinematics.support_distance([0.0, 0.0], SQUARE, np.zeros(4)) == np.inf
    assert polygon_distance([0.0, 0.0], np.zeros((0, 2))) == np.inf


@settings(max_examples=150, deadline=None)
@given(
    st.lists(st.floats(-1.0, 1.0), min_size=10, max_size=10),
    st.lists(st.booleans(), min_size=4, max_size=4),
)
def test_batched_distance_equals_the_polygon_s(values: list[float], contact: list[bool]):
    foot, point = np.round(values[:8], 3).reshape(4, 2), np.round(values[8:], 3)
    one = kinematics.support_distance(point, foot, contact)
    polygon = support_polygon(foot, contact)
    expected = polygon_distance(point, polygon)
    np.testing.assert_allclose(one, expected, atol=1e-9)


def test_the_center_of_mass_falls_along_gravity():
    # gravity tilted by 45 degrees towards +x: from 0.3 m up it lands 0.3 m further
    gravity = np.array([1.0, 0.0, -1.0])
    np.testing.assert_allclose(kinematics.along_gravity([0.1, 0.2, 0.3], gravity), [0.4, 0.2])
