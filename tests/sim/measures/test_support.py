"""Margins in the support polygon, against the polygons of Shapely."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from shapely import MultiPoint, Point

from legpush.arrays import Flags, Floats
from sim_proc.measures.support import support_margins
from tests.robots import ROBOT

RECTANGLE = ROBOT.stance.foot_rectangle_b()
PLACE = st.floats(-0.5, 0.5)


def margin(point: tuple[float, float], feet: Floats, loaded: Flags) -> float:
    return float(support_margins(np.array([[point]]), feet[None], loaded[None])[0, 0])


def by_shapely(point: tuple[float, float], feet: Floats, loaded: Flags) -> float:
    """The distance to the border of the convex hull, inside positive."""
    hull, there = MultiPoint(feet[loaded]).convex_hull, Point(point)
    if hull.geom_type == "Polygon" and hull.contains(there):
        return float(hull.exterior.distance(there))
    return -float(hull.distance(there))


@given(
    st.tuples(PLACE, PLACE),
    st.lists(st.tuples(st.floats(-0.2, 0.2), st.floats(-0.2, 0.2)), min_size=4, max_size=4),
    st.lists(st.booleans(), min_size=4, max_size=4).filter(any),
    st.permutations(range(4)),
)
def test_margins_are_those_of_shapely_wherever_the_feet_are(
    point: tuple[float, float], steps: list[tuple[float, float]], loaded: list[bool], order: list[int]
) -> None:
    feet, flags = (RECTANGLE + np.array(steps))[order], np.array(loaded)
    assert margin(point, feet, flags) == pytest.approx(by_shapely(point, feet, flags), abs=1e-9)


def test_a_foot_within_the_triangle_of_the_others_makes_no_corner() -> None:
    feet = np.array([[0.0, 0.0], [1.0, 0.0], [0.4, 0.2], [0.0, 1.0]])
    for point in ((0.45, 0.45), (0.2, 0.1), (0.9, 0.3), (0.4, 0.2)):
        for loaded in (np.ones(4, dtype=bool), np.array([True, True, False, True])):
            assert margin(point, feet, loaded) == pytest.approx(by_shapely(point, feet, loaded), abs=1e-12)


def test_without_a_loaded_foot_the_margin_is_the_distance_to_the_middle_of_the_feet() -> None:
    assert margin((0.3, 0.4), RECTANGLE, np.zeros(4, dtype=bool)) == pytest.approx(-0.5)


def test_several_points_and_steps_are_kept_apart() -> None:
    rng = np.random.default_rng(0)
    points, feet = rng.uniform(-0.4, 0.4, (3, 50, 2)), RECTANGLE + rng.uniform(-0.1, 0.1, (50, 4, 2))
    loaded = rng.uniform(size=(50, 4)) < 0.8
    alone = [[margin(tuple(points[k, n]), feet[n], loaded[n]) for n in range(50)] for k in range(3)]
    np.testing.assert_allclose(support_margins(points, feet, loaded), alone, atol=1e-12)
