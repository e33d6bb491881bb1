"""Zero-moment point, capture point and the moment of the feet about the centre of mass."""

import numpy as np
import pytest

from legpush.arrays import Floats
from sim_proc.gravity import GRAVITY_M_S2
from sim_proc.measures.stability import capture_points, foot_moments_n_m, zero_moment_points
from tests.robots import ROBOT

HEIGHT_M = ROBOT.stance.com_height_m
LEVEL = np.zeros(2)


def feet() -> Floats:
    tips = np.zeros((1, 4, 3))
    tips[0, :, :2], tips[0, :, 2] = ROBOT.stance.foot_rectangle_b(), ROBOT.legs.foot_radius_m
    return tips


def test_forces_through_the_zero_moment_point_have_no_moment_there() -> None:
    loads = np.array([[10.0, 20.0, 0.0, 70.0]])
    x, y = zero_moment_points(feet(), loads, np.zeros((1, 3)))[0]
    arms = feet()[0, :, :2] - [x, y]
    np.testing.assert_allclose(loads[0] @ arms, 0.0, atol=1e-12)


def test_a_robot_in_the_air_has_its_com_in_the_place_of_the_zero_moment_point() -> None:
    com = np.array([[0.1, -0.2, 0.6]])
    np.testing.assert_array_equal(zero_moment_points(feet(), np.zeros((1, 4)), com), com[:, :2])


@pytest.mark.parametrize("downhill", [LEVEL, np.array([0.1, -0.05])])
def test_a_pendulum_over_its_capture_point_comes_to_rest_above_it(downhill: Floats) -> None:
    """Integrated with the zero-moment point held at the capture point; on a slope gravity pulls downhill."""
    com, velocity = np.array([[0.0, 0.0, HEIGHT_M]]), np.array([[0.3, -0.2, 0.0]])
    point = capture_points(com, velocity, downhill, HEIGHT_M)[0]
    place, speed, dt = com[0, :2].copy(), velocity[0, :2].copy(), 1e-4
    for _ in range(30_000):
        speed += dt * (GRAVITY_M_S2 / HEIGHT_M * (place - point) + GRAVITY_M_S2 * downhill)
        place += dt * speed
        if np.abs(speed).max() < 1e-3:
            break
    np.testing.assert_allclose(place + HEIGHT_M * downhill, point, atol=2e-3)
    assert np.abs(speed).max() < 1e-3


def test_the_moment_of_the_feet_is_the_sum_of_eq_9_by_hand() -> None:
    floor, box = np.zeros((1, 4, 3)), np.zeros((1, 4, 3))
    floor[0, 3] = [0.0, 5.0, 100.0]
    box[0, 0] = [-20.0, 0.0, 0.0]
    com = np.array([[0.05, 0.0, 0.43]])
    seen = foot_moments_n_m(feet(), floor, box, com, ROBOT.legs.foot_radius_m)[0]
    length, width = ROBOT.stance.foot_rectangle_length_m / 2, ROBOT.stance.foot_rectangle_width_m / 2
    of_floor = np.cross([-length - 0.05, -width, -0.43], [0.0, 5.0, 100.0])
    of_box = np.cross([length - 0.05, width, ROBOT.legs.foot_radius_m - 0.43], [-20.0, 0.0, 0.0])
    np.testing.assert_allclose(seen, of_floor + of_box)
