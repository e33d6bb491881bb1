"""A robot regains its footing: feet in the air go down until they feel the floor, and the others stay."""

import numpy as np
import pytest

from legpush.arrays import Floats
from legpush.geometry import Pose2
from legpush.scene.scenario import Scenario
from sim_proc.control.feedback.footing import HOLD_TICKS, Footing
from sim_proc.control.posture import Posture
from sim_proc.gravity import GRAVITY_M_S2
from sim_proc.physics.physics import Physics
from tests.robots import ROBOT

START = Pose2(x_m=2.0, y_m=3.0, yaw_rad=0.4)
LIFTED_M = 0.03
ROUGH = ROBOT.rough


@pytest.fixture
def posture(at_the_box: Scenario) -> Posture:
    """A robot that stands."""
    physics = Physics(at_the_box, START, at_the_box.box.pose.pose())
    posture = Posture(physics)
    posture.stand(25)
    return posture


def lift(posture: Posture, leg: int) -> None:
    """Lift a foot within two ticks, without shifting the weight before."""
    forces = np.zeros((4, 3))
    forces[:, 2] = posture.plant.mass_kg * GRAVITY_M_S2 / 3
    forces[leg] = 0.0
    for _ in range(2):
        tips_b = posture.commanded_tips_b()
        tips_b[leg, 2] += LIFTED_M / 2
        posture.react(tips_b, forces)


@pytest.mark.parametrize("leg", [0, 3])
def test_a_foot_in_the_air_goes_down_until_it_carries_load(posture: Posture, leg: int) -> None:
    lift(posture, leg)
    plant, before = posture.plant, posture.joints_rad.copy()
    assert plant.body_state().loads_n[leg] == 0.0

    logs = Footing(posture).run()

    state = plant.body_state()
    assert (state.loads_n > 5.0).all()
    assert not plant.fallen
    per_tick_m = ROUGH.reflex_m_s * 0.02
    assert LIFTED_M / per_tick_m <= len(logs) - HOLD_TICKS <= LIFTED_M / per_tick_m + 4
    others = np.delete(np.arange(12).reshape(4, 3), leg, axis=0).ravel()
    np.testing.assert_allclose(posture.joints_rad[others], before[others], atol=1e-6)
    heights: Floats = state.tips_m[:, 2]
    np.testing.assert_allclose(heights, ROBOT.touchdown_m, atol=0.006)


def test_a_robot_that_stands_holds_its_legs(posture: Posture) -> None:
    before = posture.plant.tips_m().copy()
    assert len(Footing(posture).run()) == HOLD_TICKS
    np.testing.assert_allclose(posture.plant.tips_m(), before, atol=0.003)
