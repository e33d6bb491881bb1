"""Which way is down, by an accelerometer on a trunk that may move and turn."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from legpush.arrays import Floats
from sim_proc.estimation.plumb_line import ADAPTS_S, DOUBT, PlumbLine

LEVEL = np.zeros(2)
N_TICKS = 20
DURATION_S = 0.4


def felt(plumb_line: PlumbLine, downhill: Floats, acceleration_m_s2: Floats | None = None) -> Floats:
    """What is taken for downhill after a motion of 0.4 s on a slope, with a trunk that leans and accelerates."""
    gravity = 9.81 * np.array([*downhill, -1.0]) / np.linalg.norm([*downhill, 1.0])
    acceleration = np.zeros(3) if acceleration_m_s2 is None else acceleration_m_s2
    leans = Rotation.from_euler("zyx", [0.7, 0.05, -0.03])
    read = leans.inv().apply(acceleration - gravity)
    wxyz = np.roll(leans.as_quat(), 1)
    plumb_line.feel(np.tile(read, (N_TICKS, 10, 1)), np.tile(wxyz, (N_TICKS, 1)), DURATION_S * acceleration)
    return plumb_line.downhill


@pytest.mark.parametrize("downhill", [(0.1, -0.05), (-0.17, 0.0)])
def test_an_unknown_slope_is_felt_while_the_robot_stands(downhill: tuple[float, float]) -> None:
    np.testing.assert_allclose(felt(PlumbLine(LEVEL), np.array(downhill)), downhill, atol=1e-9)


def test_the_motion_of_the_trunk_is_not_taken_for_a_slope() -> None:
    assert felt(PlumbLine(LEVEL), LEVEL, np.array([2.0, -1.0, 0.5])).tolist() == [0.0, 0.0]
    slope = np.array([0.1, 0.0])
    np.testing.assert_allclose(felt(PlumbLine(LEVEL), slope, np.array([2.0, -1.0, 0.5])), slope, atol=1e-9)


def test_a_slope_that_is_nearly_the_assumed_one_leaves_that_as_it_is() -> None:
    assumed = np.array([0.08, 0.0])
    plumb_line = PlumbLine(assumed)
    assert felt(plumb_line, np.add(assumed, [0.9 * DOUBT, 0.0])) is assumed
    for _ in range(9):
        felt(plumb_line, np.add(assumed, [0.7 * DOUBT, 0.0]))
    assert plumb_line.downhill is assumed


def test_another_slope_is_believed_little_by_little() -> None:
    plumb_line = PlumbLine(LEVEL)
    felt(plumb_line, LEVEL)
    slope = np.array([0.1, 0.0])
    expected = slope * (1 - np.exp(-DURATION_S / ADAPTS_S))
    np.testing.assert_allclose(felt(plumb_line, slope), expected, atol=1e-9)
