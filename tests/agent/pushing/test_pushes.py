"""One push: approached if need be, counted, published, and learned from."""

from itertools import pairwise
from math import pi

import pytest
from msgspec.structs import replace

from agent_proc.endings import MissionEndedError
from agent_proc.frames.push_view import push_view
from agent_proc.mission.mission import run_mission
from agent_proc.policies.scripted import ScriptedPolicy
from agent_proc.push_model.map import PushMap
from agent_proc.task.episode import earned
from agent_proc.task.term import PushStep
from legpush.messages.planning import Plan
from legpush.messages.stepping import Follow, Push
from legpush.scene.names import Face
from legpush.scene.scenario import Goal, PoseDeg, PushSettings, Room
from planner_proc.planning import make_plan
from tests.agent.fake_world import FakeWorld, make_scenario, scenario_at_station
from tests.agent.parts import parts_in
from tests.agent.push_model.maps import measured
from tests.agent.tasks import tuned


def test_a_mission_plans_by_the_map() -> None:
    scenario = replace(
        make_scenario(room=Room(size_m=(12.0, 6.0))), goal=Goal(pose=PoseDeg(x_m=8.0, y_m=4.0, yaw_deg=90.0))
    )
    queries = []
    for push_map in (None, turning_twice()):
        world = FakeWorld(planner=make_plan)
        run_mission(world, scenario, 3, ScriptedPolicy(), push_map)
        queries.append(world.box_queries()[0])

    radii = [query.sides[0].min_turning_radius_m for query in queries]
    assert radii[1] == pytest.approx(radii[0] / 2, rel=1e-3)


def turning_twice() -> PushMap:
    """The map of a box that turns twice as much."""
    push_map = measured()
    return replace(push_map, effects=tuple(replace(e, turn_deg=2 * e.turn_deg) for e in push_map.effects))


def push(face: Face = "rear") -> Push:
    return Push(w1=0.5, w2=0.5, leg="FR", depth_m=0.05, face=face)


def test_a_push_from_the_station_is_carried_out_and_counted_at_once() -> None:
    parts = parts_in(FakeWorld(), scenario_at_station())

    for _ in range(3):
        parts.pushes.push(push(), learn=False)

    assert parts.world.motions(Push) == [push()] * 3
    assert parts.world.motions(Follow) == []
    assert parts.pushes.n_cycles == 3


def test_a_push_from_elsewhere_begins_with_an_approach_to_its_face() -> None:
    parts = parts_in(FakeWorld(), make_scenario())

    parts.pushes.push(push("right"), learn=False)

    (query,) = parts.world.queries()
    assert query.goal.yaw_rad == pytest.approx(pi / 2)
    assert parts.world.motions(Push) == [push("right")]


def test_a_push_without_a_way_to_its_face_is_not_counted() -> None:
    world = FakeWorld(planner=lambda _: Plan(status="failed", reason="nothing found"))
    parts = parts_in(world, make_scenario())

    with pytest.raises(MissionEndedError, match="nothing found"):
        parts.pushes.push(push(), learn=True)
    assert parts.pushes.n_cycles == 0
    assert world.rewards == []


def test_each_push_earns_what_it_would_in_training() -> None:
    parts = parts_in(FakeWorld(), scenario_at_station())
    views = [push_view(parts.actor.state, parts.actor.scenario)]

    for _ in range(2):
        parts.pushes.push(push(), learn=False)
        views.append(push_view(parts.actor.state, parts.actor.scenario))

    assert parts.world.rewards == [
        earned(tuned(), PushStep(first=views[0], before=before, after=after, ending=None))
        for before, after in pairwise(views)
    ]
    assert parts.world.rewards[0] != parts.world.rewards[1]


def test_a_push_in_which_the_robot_falls_counts_and_earns_nothing() -> None:
    parts = parts_in(FakeWorld(falls_in=lambda motion, _: isinstance(motion, Push)), scenario_at_station())

    with pytest.raises(MissionEndedError, match="the robot fell during push"):
        parts.pushes.push(push(), learn=True)
    assert parts.pushes.n_cycles == 1
    assert parts.world.rewards == []
    assert parts.pushes.estimates["rear"].travel_scale == 1.0


@pytest.mark.parametrize("learn", [True, False])
def test_the_estimate_of_the_pushed_face_learns_if_asked_to(learn: bool) -> None:
    parts = parts_in(FakeWorld(push_scale=0.6), scenario_at_station())

    for _ in range(5):
        parts.pushes.push(push(), learn=learn)

    scales = {face: estimate.travel_scale for face, estimate in parts.pushes.estimates.items()}
    assert (scales["rear"] < 0.8) == learn
    assert {scales[face] for face in ("front", "left", "right")} == {1.0}


def test_there_are_estimates_for_the_faces_that_may_be_pushed_alone() -> None:
    scenario = make_scenario(pushing=PushSettings(faces=("rear", "left")))

    assert list(parts_in(FakeWorld(), scenario).pushes.estimates) == ["rear", "left"]
