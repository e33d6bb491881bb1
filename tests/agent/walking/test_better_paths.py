"""Better paths between gait cycles: when they are waited for, and which are taken."""

from itertools import pairwise
from math import hypot, pi

import numpy as np
import pytest
from msgspec.structs import replace

from agent_proc.endings import MissionResult
from agent_proc.mission.mission import run_mission
from agent_proc.policies.scripted import ScriptedPolicy
from agent_proc.walking.better_paths import BetterPaths
from legpush.errors import BadAnswerError
from legpush.geometry import Pose2
from legpush.messages.planning import Plan, PlanQuery, TrunkPathQuery
from legpush.messages.stepping import Follow
from legpush.scene.paths import path_length_m
from legpush.scene.plan_settings import Anytime, PlanSettings
from legpush.scene.scenario import Rectangle, Room
from tests.agent.fake_world import FakeWorld, make_scenario, straight_plan
from tests.planner import maps
from tests.planner.bodies import BODY, BODY_M
from tests.robots import CIRCLE_M

ANYTIME = Anytime(n_improvements=4, improvement_iterations=10)
FAR = make_scenario((1.0, 3.0, 0.0), planning=PlanSettings(anytime=ANYTIME))


def path(*corners: tuple[float, float]) -> Plan:
    """An exact plan along a polyline, turning on the spot."""
    waypoints: list[Pose2] = []
    for a, b in pairwise(corners):
        heading = float(np.arctan2(b[1] - a[1], b[0] - a[0]))
        points = np.linspace(a, b, 2 + int(hypot(b[0] - a[0], b[1] - a[1]) / 0.05))
        waypoints += [Pose2(x_m=x, y_m=y, yaw_rad=heading) for x, y in points.tolist()]
    return Plan(
        status="exact",
        reason="",
        waypoints=tuple(waypoints),
        length_m=path_length_m(tuple(waypoints), CIRCLE_M),
    )


def detour(query: PlanQuery) -> Plan:
    """Not straight, but over a place 1 m to the left of the middle."""
    (x, y), (goal_x, goal_y) = query.start.xy().tolist(), query.goal.xy().tolist()
    plan = path((x, y), ((x + goal_x) / 2, y + 1.5), (goal_x, goal_y))
    waypoints = (query.start, *plan.waypoints, query.goal)
    return replace(plan, waypoints=waypoints) if isinstance(query, TrunkPathQuery) else straight_plan(query)


def run(world: FakeWorld, **changes: object) -> MissionResult:
    return run_mission(world, replace(FAR, **changes), 7, ScriptedPolicy())


def test_a_better_path_is_joined_after_the_first_gait_cycle_and_makes_the_way_shorter() -> None:
    usual, better = FakeWorld(planner=detour), FakeWorld(planner=detour)
    better.better = lambda query, _: replace(straight_plan(query), length_m=1.0)
    first = run(usual, planning=PlanSettings())
    result = run(better)
    assert first.n_better_paths == 0
    assert result.success
    assert result.n_better_paths >= 1
    assert better.simulator.tick < usual.simulator.tick
    assert len(better.motions(Follow)) == len(usual.motions(Follow)) + result.n_better_paths


def test_a_path_that_is_no_better_is_not_taken() -> None:
    world = FakeWorld(planner=detour)
    world.better = lambda query, _: detour(query)
    assert run(world).n_better_paths == 0


def test_each_revision_is_waited_for_once_and_the_rest_is_cancelled_at_the_end_of_the_walk() -> None:
    asked: list[int] = []

    def better(query: PlanQuery, revision: int) -> Plan:
        asked.append(revision)
        return detour(query)

    world = FakeWorld(planner=detour)
    world.better = better
    run(world)
    n_walks = len(world.queries()) - len(asked)
    assert asked[:4] == [1, 2, 3, 4]
    assert asked.count(4) <= n_walks
    assert world.n_cancelled == n_walks


def better_paths(grid_room: Room | None = None) -> BetterPaths:
    grid = maps.room() if grid_room is None else maps.room((3.9, 4.1, 0.0, 4.0))
    query = maps.query(grid, (1.0, 1.0), (7.0, 1.0), anytime=ANYTIME)
    return BetterPaths(query, replace(path((1.0, 1.0), (4.0, 5.0), (7.0, 1.0)), length_m=10.0), CIRCLE_M)


def test_the_join_goes_straight_to_a_place_on_the_new_path_and_turns_along_it() -> None:
    here = Pose2(x_m=1.6, y_m=1.8, yaw_rad=0.9)
    joined = better_paths().joined(path((1.0, 1.0), (7.0, 1.0)), here, 8.0)
    assert joined[0] == here
    assert joined[-1] == Pose2(x_m=7.0, y_m=1.0, yaw_rad=0.0)
    assert path_length_m(joined, CIRCLE_M) < 7.4
    assert max(hypot(*(b.xy() - a.xy())) for a, b in pairwise(joined)) <= 0.06


def test_a_join_through_a_wall_is_not_taken() -> None:
    walled = Room(size_m=(8.0, 6.0), obstacles=(Rectangle(x_min_m=3.9, x_max_m=4.1, y_min_m=0.0, y_max_m=4.0),))
    here = Pose2(x_m=3.2, y_m=2.0, yaw_rad=pi / 2)
    beyond = path((5.0, 1.0), (7.0, 1.0))
    assert better_paths().joined(beyond, here, 20.0)
    assert better_paths(walled).joined(beyond, here, 20.0) == ()


def test_after_a_plan_only_a_shorter_one_is_looked_at() -> None:
    better, here = better_paths(), Pose2(x_m=1.6, y_m=1.8, yaw_rad=0.9)
    plan = path((1.0, 1.0), (7.0, 1.0))
    assert better.joined(plan, here, 8.0)
    assert better.joined(replace(plan, length_m=plan.length_m + 0.1), here, 20.0) == ()


def test_a_robot_that_is_nearer_to_something_than_planned_may_leave_it() -> None:
    query = maps.query(maps.room((2.0, 3.0, 0.0, 1.0)), (1.0, 2.0), (7.0, 2.0), anytime=ANYTIME, clearance_m=0.6)
    better = BetterPaths(query, replace(path((1.0, 2.0), (7.0, 5.0)), length_m=10.0), CIRCLE_M)
    assert better.joined(path((1.0, 2.0), (7.0, 2.0)), Pose2(x_m=2.5, y_m=1.5, yaw_rad=0.0), 20.0)


def test_a_better_plan_that_cannot_be_followed_is_the_planners_fault() -> None:
    world = FakeWorld(planner=detour)
    world.better = lambda query, _: Plan(status="exact", reason="", length_m=1.0)
    result = run(world)
    assert result.reason == "bad_answer"
    assert "revision 1 of the way: expected a plan that can be followed" in result.detail
    assert isinstance(result.error, BadAnswerError)


def test_once_something_has_appeared_no_better_path_is_taken_from_the_map_without_it() -> None:
    aside = Rectangle(x_min_m=4.0, x_max_m=4.2, y_min_m=0.2, y_max_m=0.4, appears_at_s=1.0)
    world = FakeWorld(planner=detour)
    world.better = lambda query, _: replace(straight_plan(query), length_m=1.0)
    result = run(world, room=Room(size_m=(12.0, 6.0), obstacles=(aside,)))
    assert result.success
    assert result.n_better_paths < 2


@pytest.mark.parametrize("status", ["approximate", "failed"])
def test_only_exact_plans_are_joined(status: str) -> None:
    plan = replace(path((1.0, 1.0), (7.0, 1.0)), status=status)
    assert better_paths().joined(plan, Pose2(x_m=1.6, y_m=1.8, yaw_rad=0.9), 8.0) == ()


def test_revisions_are_counted_and_end() -> None:
    better = better_paths()
    assert [better.next_revision() for _ in range(6)] == [1, 2, 3, 4, None, None]


def test_a_join_is_not_taken_where_the_body_would_turn_into_a_wall() -> None:
    here = Pose2(x_m=2.5, y_m=0.5, yaw_rad=0.0)
    disc = maps.query(maps.room(), (1.0, 1.0), (7.0, 1.0), anytime=ANYTIME)
    usual = replace(path((1.0, 1.0), (4.0, 5.0), (7.0, 1.0)), length_m=10.0)
    shorter = path((2.5, 1.5), (2.5, 3.0))

    def joined(query: TrunkPathQuery) -> tuple[Pose2, ...]:
        return BetterPaths(query, usual, CIRCLE_M).joined(shorter, here, 20.0)

    assert joined(disc)
    assert not joined(replace(disc, body=BODY, body_clearance_m=BODY_M))
