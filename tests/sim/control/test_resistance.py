"""What the pushing foot feels of a box."""

import numpy as np
import pytest
from msgspec.structs import replace

from legpush.scene.scenario import Box, PoseDeg
from sim_proc.control.resistance import STRUCK_TICKS, Resistance

BOX = replace(Box(pose=PoseDeg(x_m=0.0, y_m=0.0, yaw_deg=0.0)), mass_kg=20.0, friction=0.5)


def felt(*forward_n: float) -> np.ndarray:
    return np.array([[forward, 0.2 * forward, 0.1 * forward] for forward in forward_n])


def test_the_first_push_expects_the_friction_of_the_scenario() -> None:
    np.testing.assert_allclose(Resistance(BOX).force_n, [98.1, 0.0, 0.0], atol=0.1)


def test_pushes_lead_to_what_the_foot_feels() -> None:
    resistance = Resistance(BOX)
    for _ in range(12):
        resistance.feel(felt(*[0.0] * 5, *[60.0] * 20))
    np.testing.assert_allclose(resistance.force_n, [60.0, 12.0, 6.0], atol=0.02)


def test_the_stroke_at_the_first_contact_does_not_count() -> None:
    resistance = Resistance(replace(BOX, mass_kg=0.1))
    resistance.feel(felt(0.0, *[200.0] * STRUCK_TICKS, 0.5, 0.5, 0.5))
    assert resistance.force_n[0] < 1.0


@pytest.mark.parametrize("forces", [felt(0.0, 0.0), felt(5.0, 5.0), np.zeros((0, 3))])
def test_a_push_that_hardly_touches_the_box_says_nothing(forces: np.ndarray) -> None:
    resistance = Resistance(BOX)
    before = resistance.force_n.copy()
    resistance.feel(forces)
    np.testing.assert_array_equal(resistance.force_n, before)
