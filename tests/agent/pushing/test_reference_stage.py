"""The reference of a scenario as a stage."""

import numpy as np
import pytest

from agent_proc.pushing.reference_stage import trailing
from legpush.scene.reference import reference_curve
from tests.agent.pushing.paths import EIGHT, START


@pytest.mark.parametrize("axle_m", [0.0, 0.15, 0.3])
def test_headings_along_a_curve_are_those_of_a_box_that_does_not_slip(axle_m: float) -> None:
    curve = reference_curve(EIGHT, START)
    headings = trailing(curve, axle_m)

    axles = curve[:, :2] - axle_m * np.stack([np.cos(headings), np.sin(headings)], axis=1)
    steps = np.diff(axles, axis=0)
    middle = (headings[1:] + headings[:-1]) / 2
    sideways = np.cos(middle) * steps[:, 1] - np.sin(middle) * steps[:, 0]
    assert np.abs(sideways).max() < 1e-5
