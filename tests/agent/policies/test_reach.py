"""How far off a policy was trained, and that it stops beyond that."""

import logging
from math import degrees, radians

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from msgspec.structs import replace as changed

from agent_proc.frames.push_view import PushView, push_view
from agent_proc.policies.learned import NetworkPolicy
from agent_proc.policies.reach import Reach, Visits, reach_of
from legpush.geometry import Pose2
from legpush.scenarios.file import load_scenario
from legpush.scene.scenario import PoseDeg
from tests.agent.fake_world import make_state
from tests.agent.tasks import tuned

SCENARIO = load_scenario("open")
BOX = SCENARIO.box.pose
places = st.tuples(st.floats(-0.5, 0.5), st.floats(-90.0, 90.0))


def view_of(beside_m: float, turned_deg: float) -> PushView:
    """The box 1 m before a goal whose heading is 0, to the left of the line and turned to the left."""
    pose = PoseDeg(x_m=BOX.x_m + 1.0, y_m=BOX.y_m - beside_m, yaw_deg=0.0)
    scenario = changed(SCENARIO, goal=changed(SCENARIO.goal, pose=pose))
    at = Pose2(x_m=BOX.x_m, y_m=BOX.y_m, yaw_rad=radians(turned_deg))
    return push_view(make_state(scenario.start.pose(), at), scenario)


class Straight:
    """Pushes as deep as possible."""

    def act(self, observation: object) -> np.ndarray:
        """The deepest push with the usual curve."""
        return np.array([0.0, 0.0, -1.0, 1.0])


@given(places)
def test_it_is_the_distance_from_the_line_and_the_angle_to_either_side(place: tuple[float, float]) -> None:
    reach = reach_of(view_of(*place))
    assert (reach.beside_m, reach.turned_deg) == pytest.approx(tuple(map(abs, place)), abs=1e-6)
    assert reach.covers(view_of(*place))


@given(st.lists(places, min_size=1, max_size=5))
def test_what_a_few_decisions_were_about_is_covered(seen: list[tuple[float, float]]) -> None:
    reach = Visits().with_views(view_of(*each) for each in seen).reach
    assert all(reach.covers(view_of(*each)) for each in seen)
    assert reach.beside_m <= max(abs(beside_m) for beside_m, _ in seen) + 0.01 + 1e-9
    assert reach.turned_deg <= max(abs(turned_deg) for _, turned_deg in seen) + 1.0 + 1e-9


def test_one_decision_in_a_hundred_may_be_about_a_box_that_is_farther_off() -> None:
    visits = Visits().with_views([view_of(0.055, 3.5)] * 99)

    for n_far, reach in ((1, (0.06, 4.0)), (2, (0.31, 41.0))):
        visits = visits.with_views([view_of(0.305, 40.5)])
        found = visits.reach
        assert (found.beside_m, found.turned_deg) == pytest.approx(reach), n_far


def test_all_that_is_far_off_counts_as_one_place() -> None:
    assert Visits().with_views([view_of(5.0, 179.99)]).reach == Reach(beside_m=1.8, turned_deg=180.0)


def test_a_policy_stops_beyond_its_reach_and_says_so_once(caplog: pytest.LogCaptureFixture) -> None:
    policy = NetworkPolicy(tuned(), Straight(), None, "mine", Reach(beside_m=0.1, turned_deg=degrees(0.3)))

    with caplog.at_level(logging.INFO):
        decisions = [policy.decide(view_of(*place)) for place in ((0.09, 17.0), (0.11, 0.0), (0.0, -18.0))]

    assert [decision is None for decision in decisions] == [False, True, True]
    warnings = [record.getMessage() for record in caplog.records if record.levelno == logging.WARNING]
    assert warnings == [
        "mine stops: the box is 11.0 cm beside the line to its goal and turned by 0.0°, and it was trained up to "
        "10.0 cm beside the line to its goal and turned by 17.2°"
    ]
    assert len(caplog.records) == 2


def test_a_policy_of_unknown_reach_does_not_stop() -> None:
    assert NetworkPolicy(tuned(), Straight(), None, "mine").decide(view_of(0.4, 60.0)) is not None
