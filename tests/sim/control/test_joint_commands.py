"""Commands between the ticks of a plan."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import CubicHermiteSpline

from legpush.scene.conventions import CONTROL_PERIOD_S
from sim_proc.control.joint_commands import COMMANDS_PER_TICK, interpolated, knots

N = 5


@given(st.integers(0, 2**32 - 1))
def test_commands_are_the_cubic_spline_through_the_knots_at_the_beginning_of_each_step(seed: int) -> None:
    rng = np.random.default_rng(seed)
    at = knots(rng.normal(size=12), rng.normal(size=12), rng.normal(size=(N, 12)))
    commands = interpolated(at, rng.normal(size=(N + 1, 12)))
    ticks = CONTROL_PERIOD_S * np.arange(N + 1)
    spline = CubicHermiteSpline(ticks, at.positions_rad, at.velocities_rad_s)
    times = CONTROL_PERIOD_S / COMMANDS_PER_TICK * np.arange(N * COMMANDS_PER_TICK)
    np.testing.assert_allclose(commands.positions_rad.reshape(-1, 12), spline(times), atol=1e-9)
    np.testing.assert_allclose(commands.velocities_rad_s.reshape(-1, 12), spline(times, 1), atol=1e-7)


def test_a_motion_of_constant_acceleration_has_its_velocities_and_accelerations() -> None:
    time = CONTROL_PERIOD_S * np.arange(N + 1)[:, None] * np.ones(12)
    at = knots(np.zeros(12), np.zeros(12), (0.5 * 3.0 * time**2)[1:])
    np.testing.assert_allclose(at.velocities_rad_s, 3.0 * time, atol=1e-9)
    np.testing.assert_allclose(at.accelerations_rad_s2, 3.0, atol=1e-9)


def test_torques_change_evenly_from_tick_to_tick() -> None:
    at = knots(np.zeros(12), np.zeros(12), np.zeros((1, 12)))
    torques = interpolated(at, np.array([np.zeros(12), np.full(12, 10.0)])).torques_n_m
    np.testing.assert_allclose(torques[0, :, 0], 10.0 * np.arange(COMMANDS_PER_TICK) / COMMANDS_PER_TICK)
