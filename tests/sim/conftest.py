"""Worlds to test the simulator in."""

import pytest

from legpush.scene.scenario import Box, Goal, PoseDeg, Room, Scenario
from tests.robots import ROBOT

BOX_X_M = 2.0 + 0.2 + ROBOT.pushing.gap_m + ROBOT.stance.foot_rectangle_length_m / 2


@pytest.fixture
def at_the_box() -> Scenario:
    """A robot that stands at the push station of a light box, on an open floor."""
    return standing_at_the_box()


def standing_at_the_box() -> Scenario:
    """The scenario of `at_the_box`."""
    return Scenario(
        name="at_the_box",
        room=Room(size_m=(12.0, 10.0)),
        start=PoseDeg(x_m=2.0, y_m=5.0, yaw_deg=0.0),
        box=Box(pose=PoseDeg(x_m=BOX_X_M, y_m=5.0, yaw_deg=0.0)),
        goal=Goal(pose=PoseDeg(x_m=BOX_X_M + 1.0, y_m=5.0, yaw_deg=0.0)),
    )
