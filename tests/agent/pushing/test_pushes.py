"""One push: approached if need be, counted, published, and learned from."""

import pytest
from msgspec.structs import replace

from agent_proc.mission.mission import run_mission
from agent_proc.policies.scripted import ScriptedPolicy
from agent_proc.push_model.map import PushMap
from legpush.scene.scenario import Goal, PoseDeg, Room
from planner_proc.planning import make_plan
from tests.agent.fake_world import FakeWorld, make_scenario
from tests.agent.push_model.maps import measured


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
