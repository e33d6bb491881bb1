"""How the trunk turns during a step."""

from math import pi

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from legpush.geometry import wrap_angle
from legpush.scene.conventions import CONTROL_PERIOD_S
from sim_proc.control.step_motion import turn

ANGLES = st.floats(-pi, pi)


@given(ANGLES, st.floats(-1.0, 1.0), ANGLES, st.integers(2, 80))
def test_a_turn_goes_on_as_it_began_and_ends_at_its_yaw_at_its_mean_rate(
    start_rad: float, rate_rad_s: float, end_rad: float, n_ticks: int
) -> None:
    yaw, rates = turn(start_rad, rate_rad_s, end_rad, n_ticks)
    change = wrap_angle(end_rad - start_rad)
    np.testing.assert_allclose(yaw[-1], start_rad + change, atol=1e-9)
    np.testing.assert_allclose(rates[-1], change / (n_ticks * CONTROL_PERIOD_S), atol=1e-9)
    whole = np.concatenate([[start_rad], yaw])
    of_knots = np.concatenate([[rate_rad_s], rates])
    # The rates of a cubic give its changes exactly, by Simpson's rule over pairs of ticks.
    simpson = CONTROL_PERIOD_S / 3 * (of_knots[:-2] + 4 * of_knots[1:-1] + of_knots[2:])
    np.testing.assert_allclose(whole[2:] - whole[:-2], simpson, atol=1e-9)
