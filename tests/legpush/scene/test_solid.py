"""The solid of a box: its centre of mass, and the way to its surface."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from legpush.scene.names import BoxShape
from legpush.scene.solid import even_com_m, steps_to_surface

SIZES: dict[BoxShape, tuple[float, float, float]] = {
    "cuboid": (0.4, 0.5, 0.3),
    "cylinder": (0.4, 0.4, 0.3),
    "wedge": (0.4, 0.5, 0.3),
    "l_shape": (0.4, 0.5, 0.3),
}
shapes = st.sampled_from(sorted(SIZES))
parts = st.floats(-1.0, 1.0).filter(lambda part: abs(part) > 1e-3)


def is_inside(shape: BoxShape, points: np.ndarray) -> np.ndarray:
    """Whether points (n, 3) in the frame of the box are within its solid."""
    x, y, z = points.T
    length, width, height = SIZES[shape]
    solid: np.ndarray = (np.abs(x) < length / 2) & (np.abs(y) < width / 2) & (np.abs(z) < height / 2)
    match shape:
        case "cylinder":
            solid &= np.hypot(x, y) < length / 2
        case "wedge":
            solid &= x / length + z / height < 0.0
        case "l_shape":
            solid &= ~((x > 0.0) & (y < 0.0))
    return solid


@pytest.mark.parametrize("shape", SIZES)
def test_the_centre_of_mass_is_the_mean_of_the_points_in_the_solid(shape: BoxShape) -> None:
    points = (np.random.default_rng(0).random((200_000, 3)) - 0.5) * SIZES[shape]
    np.testing.assert_allclose(
        even_com_m(shape, SIZES[shape]), points[is_inside(shape, points)].mean(axis=0), atol=2e-3
    )


@given(shapes, st.tuples(parts, parts, parts))
def test_all_of_the_way_to_the_surface_is_in_the_solid_and_what_follows_is_not(
    shape: BoxShape, step: tuple[float, float, float]
) -> None:
    steps = steps_to_surface(shape, SIZES[shape], step)
    shares = np.array([*np.linspace(0.0, 0.999, 20), 1.001])
    points = np.array(even_com_m(shape, SIZES[shape])) + steps * shares[:, None] * np.array(step)
    inside = is_inside(shape, points)
    assert inside[:-1].all()
    assert not inside[-1]


@pytest.mark.parametrize("shape", SIZES)
def test_no_step_never_leads_to_the_surface(shape: BoxShape) -> None:
    assert steps_to_surface(shape, SIZES[shape], (0.0, 0.0, 0.0)) == np.inf
