"""ZMP preview and foot forces."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from legpush.scene.conventions import CONTROL_PERIOD_S
from sim_proc.control.balance import foot_forces, plan_com, shifted_reference, triangle_margin
from sim_proc.gravity import GRAVITY_M_S2
from tests.robots import ROBOT


@given(st.integers(0, 3), st.floats(-0.1, 0.1), st.floats(-0.1, 0.1))
def test_the_shifted_reference_has_the_margin_and_lies_towards_the_centroid(lifted: int, x: float, y: float) -> None:
    nominal = np.array([x, y])
    support = np.delete(ROBOT.stance.foot_rectangle_b(), lifted, axis=0)
    shifted = shifted_reference(nominal, support, 0.05)
    assert triangle_margin(shifted[None], support)[0] >= 0.05 - 1e-9
    to_centroid = support.mean(axis=0) - nominal
    moved = shifted - nominal
    assert to_centroid[0] * moved[1] - to_centroid[1] * moved[0] == pytest.approx(0.0, abs=1e-12)


def test_a_reference_with_margin_enough_stays_where_it_is() -> None:
    support = ROBOT.stance.foot_rectangle_b()[:3]
    centroid = support.mean(axis=0)
    np.testing.assert_array_equal(shifted_reference(centroid, support, 0.05), centroid)


def test_the_planned_com_starts_in_its_state_obeys_the_pendulum_and_brings_the_zmp_to_its_reference() -> None:
    n, height = 200, 0.43
    state = np.array([[0.0, 0.1], [0.05, 0.0], [0.0, 0.0]])
    reference = np.where(np.arange(n)[:, None] < 100, [0.0, 0.05], [0.1, -0.05])
    plan = plan_com(state, reference, (1.0,) * n, np.zeros(2), height)
    np.testing.assert_allclose(plan.zmp_m, plan.position_m - height / GRAVITY_M_S2 * plan.acceleration_m_s2)
    positions = np.concatenate([state[:1], plan.position_m])
    velocities = np.concatenate([state[1:2], plan.velocity_m_s])
    mean = (velocities[1:] + velocities[:-1]) / 2
    np.testing.assert_allclose(np.diff(positions, axis=0) / CONTROL_PERIOD_S, mean, atol=2e-3)
    np.testing.assert_allclose(plan.zmp_m[50:70], reference[50:70], atol=5e-3)
    np.testing.assert_allclose(plan.zmp_m[-10:], reference[-10:], atol=5e-3)
    np.testing.assert_allclose(plan.velocity_m_s[-1], 0.0, atol=2e-2)


def test_foot_forces_carry_the_weight_balance_about_the_zmp_and_spare_the_lifted_leg() -> None:
    feet = np.concatenate([ROBOT.stance.foot_rectangle_b(), np.zeros((4, 1))], axis=1)[None]
    zmp = np.array([[0.05, 0.03]])
    acceleration = np.array([[0.2, -0.1]])
    share = np.array([[1.0, 1.0, 1.0, 0.02]])
    forces = foot_forces(feet, share, zmp, acceleration, 32.0)[0]
    assert forces[:, 2].sum() == pytest.approx(32.0 * GRAVITY_M_S2)
    np.testing.assert_allclose((forces[:, 2:] * (feet[0, :, :2] - zmp)).sum(axis=0), 0.0, atol=1e-9)
    np.testing.assert_allclose(forces[:, :2].sum(axis=0), 32.0 * acceleration[0], atol=1e-9)
    assert abs(forces[3, 2]) < 0.05 * forces[:, 2].sum()
