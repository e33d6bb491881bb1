"""The kinds of terms: the bounds that an observation has if it names none, and what a step knows."""

import numpy as np
import pytest

from agent_proc.frames.push_view import PushView, push_view
from agent_proc.task.term import BEYOND_M, EpisodeEnding, ObservationTerm, PushStep
from legpush.arrays import Floats
from legpush.geometry import Pose2
from tests.agent.fake_world import make_scenario, make_state

SCENARIO = make_scenario()
VIEW = push_view(make_state(Pose2(x_m=5.0, y_m=3.0, yaw_rad=0.0), Pose2(x_m=6.0, y_m=2.9, yaw_rad=0.0)), SCENARIO)


class Place(ObservationTerm, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Where the box is."""

    AXES = ("x", "y")

    def read(self, view: PushView, mirror_sign: float) -> Floats:
        """The place, (2,)."""
        return view.box_w.xy()


def test_bounds_are_those_of_the_room_unless_a_term_has_its_own() -> None:
    low, high = Place().limits(SCENARIO)

    np.testing.assert_array_equal(low, [-BEYOND_M, -BEYOND_M])
    np.testing.assert_array_equal(high, [12.0 + BEYOND_M, 6.0 + BEYOND_M])


@pytest.mark.parametrize(
    ("ending", "arrived"), [("success", True), ("missed", True), ("fell", False), ("max_steps", False), (None, False)]
)
def test_a_step_arrives_where_there_is_nothing_left_to_do(ending: EpisodeEnding | None, arrived: bool) -> None:
    assert PushStep(first=VIEW, before=VIEW, after=VIEW, ending=ending).arrived == arrived
