"""Forces of the feet of a robot that pushes."""

import numpy as np
import pytest

from legpush.arrays import Floats
from sim_proc.control.balance import foot_forces
from sim_proc.control.push_force import PushForce, pushing_forces
from sim_proc.gravity import GRAVITY_M_S2
from tests.robots import ROBOT

MASS_KG = 32.0
LIFTED = np.array([[1e-4, 1.0, 1.0, 1.0]])
ZMP_M = np.array([[-0.06, -0.03]])
ACCELERATION = np.array([[0.2, -0.1]])
HEIGHT_M = 0.2


def standing() -> Floats:
    """Three feet on the floor, and the front left one at a box, (1, 4, 3)."""
    corners = ROBOT.stance.foot_rectangle_b()
    feet = np.concatenate([corners, np.full((4, 1), ROBOT.legs.foot_radius_m)], axis=1)
    feet[0] = [0.5, 0.15, HEIGHT_M]
    found: Floats = np.array([feet])
    return found


def planned(force_n: list[float]) -> Floats:
    push = PushForce(leg=0, force_n=np.array([force_n]), height_m=HEIGHT_M)
    found: Floats = pushing_forces(standing(), LIFTED, ZMP_M, ACCELERATION, MASS_KG, push)[0]
    return found


def test_without_a_force_the_feet_stand_as_ever() -> None:
    np.testing.assert_allclose(
        planned([0.0, 0.0, 0.0]), foot_forces(standing(), LIFTED, ZMP_M, ACCELERATION, MASS_KG)[0], atol=1e-12
    )


def test_the_pushing_foot_gets_the_reaction_and_all_forces_still_accelerate_the_robot() -> None:
    forces = planned([80.0, 20.0, 15.0])
    np.testing.assert_allclose(forces[0], [-80.0, -20.0, -15.0], atol=0.1)
    np.testing.assert_allclose(forces.sum(axis=0), [*(MASS_KG * ACCELERATION[0]), MASS_KG * GRAVITY_M_S2], atol=1e-9)
    assert (forces[1:, 2] > 0.0).all()


def test_all_moments_about_the_zmp_are_those_of_a_robot_that_does_not_push() -> None:
    def moments(forces: Floats) -> Floats:
        arms = standing()[0] - [*ZMP_M[0], 0.0]
        arms[1:, 2] = 0.0
        found: Floats = np.cross(arms, forces).sum(axis=0)
        return found

    np.testing.assert_allclose(moments(planned([80.0, 20.0, 15.0])), moments(planned([0.0, 0.0, 0.0])), atol=0.2)


def test_a_force_begins_after_the_shift() -> None:
    push = PushForce(leg=0, force_n=np.ones((2, 3)), height_m=HEIGHT_M).after(3)
    assert push.force_n.shape == (5, 3)
    assert push.force_n[:3].sum() == pytest.approx(0.0)
    assert push.force_n[3:].sum() == pytest.approx(6.0)
