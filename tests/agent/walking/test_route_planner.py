"""Asking the planner, and the better paths of its last plan."""

from math import radians
from typing import Any

import pytest
from msgspec.structs import replace

from agent_proc.walking.route_planner import RoutePlanner, plan_fault
from legpush.errors import PeerError
from legpush.geometry import Pose2
from legpush.messages.planning import Plan, PlanQuery, TrunkPathQuery
from legpush.messages.stepping import Follow, Walk
from legpush.scene.paths import path_length_m
from legpush.scene.plan_settings import Anytime, PlanSettings
from legpush.scene.scenario import Rectangle, Room
from tests.agent.fake_world import FakeWorld, make_scenario, straight_plan
from tests.agent.parts import Parts, parts_in
from tests.robots import CIRCLE_M

FAR = make_scenario(planning=PlanSettings(anytime=Anytime(n_improvements=3, improvement_iterations=10)))
ASIDE = Rectangle(x_min_m=3.0, x_max_m=3.5, y_min_m=0.0, y_max_m=0.5, appears_at_s=1.0)
STRETCH = (Pose2(x_m=5.2, y_m=3.0, yaw_rad=0.0), Pose2(x_m=5.4, y_m=3.0, yaw_rad=0.0))


def detour(query: PlanQuery) -> Plan:
    """Over a corner 1.5 m to the left, in two straight lines."""
    if not isinstance(query, TrunkPathQuery):
        return straight_plan(query)
    corner = Pose2(x_m=3.0, y_m=4.5, yaw_rad=0.0)
    there, on = straight_plan(replace(query, goal=corner)), straight_plan(replace(query, start=corner))
    waypoints = there.waypoints + on.waypoints
    return replace(on, waypoints=waypoints, length_m=path_length_m(waypoints, CIRCLE_M))


def shorter(query: PlanQuery, revision: int) -> Plan:
    """The straight line, by each revision a little shorter, as it says."""
    return replace(straight_plan(query), length_m=4.0 - 0.1 * revision)


def detoured(**changes: Any) -> tuple[Parts, tuple[Pose2, ...]]:
    """A robot that was given a detour with better paths to come, and is one gait cycle ahead; its path."""
    parts = parts_in(FakeWorld(planner=detour, better=shorter), replace(FAR, **changes))
    plan = parts.planner.ask(parts.walker.query_behind("rear"), "the way")
    waypoints = plan.waypoints + STRETCH
    parts.actor.step(Follow(waypoints=waypoints))
    parts.actor.step(Walk())
    return parts, waypoints


def better_path(planner: RoutePlanner, waypoints: tuple[Pose2, ...], travelled_m: float = 0.4) -> tuple[Pose2, ...]:
    return planner.better_path(waypoints, travelled_m, STRETCH)


@pytest.mark.parametrize("status", ["exact", "approximate", "failed", "invalid"])
def test_the_answer_is_returned_whatever_its_status(status: str) -> None:
    world = FakeWorld(planner=lambda query: replace(straight_plan(query), status=status))
    parts = parts_in(world, make_scenario())

    plan = parts.planner.ask(parts.walker.query_behind("rear"), "the way behind the box")

    assert plan.status == status
    assert world.told == [("planning", None, "the way behind the box")]


def test_an_exact_plan_that_cannot_be_followed_is_the_fault_of_a_peer_and_another_one_is_not() -> None:
    world = FakeWorld(planner=lambda _: Plan(status="exact", reason=""))
    parts = parts_in(world, make_scenario())
    query = parts.walker.query_behind("rear")

    with pytest.raises(PeerError, match="the way: expected a plan that can be followed, but it has no waypoints"):
        parts.planner.ask(query, "the way")
    world.planner = lambda _: Plan(status="failed", reason="")
    assert parts.planner.ask(query, "the way").waypoints == ()


@pytest.mark.parametrize(
    ("change", "fault"),
    [
        ({}, ""),
        ({"waypoints": (), "sides": ()}, "it has no waypoints"),
        ({"sides": ()}, "it has 50 waypoints and 0 sides"),
        ({"sides": (0,) * 49 + (4,)}, "it names side 4 of 4"),
        ({"sides": (*(0,) * 49, 1)}, "the box does not move in the stage at (7, 3)"),
        ({"sides": (*(0,) * 48, 1, 1)}, ""),
        (
            {"waypoints": (Pose2(x_m=6.0, y_m=3.0, yaw_rad=0.0),) * 50},
            "the box does not move, although it is not at its goal",
        ),
    ],
)
def test_a_path_of_the_box_needs_a_side_and_a_move_for_each_stage(change: dict[str, Any], fault: str) -> None:
    world = FakeWorld()
    parts_in(world, make_scenario()).route.come_to_push()
    (query,) = world.box_queries()

    assert plan_fault(query, replace(straight_plan(query), **change)) == fault


@pytest.mark.parametrize("n_waypoints", [1, 2])
@pytest.mark.parametrize(
    ("off_m", "off_deg", "is_fine"), [(0.0, 0.0, True), (0.008, 0.8, True), (0.01, 0.0, False), (0.0, 1.0, False)]
)
def test_a_path_of_the_box_need_not_move_it_within_the_tolerances_of_the_goal(
    off_m: float, off_deg: float, is_fine: bool, n_waypoints: int
) -> None:
    """The tolerances of the end of a path are 9 mm and 0.9 degrees."""
    world = FakeWorld()
    parts_in(world, make_scenario()).route.come_to_push()
    query = replace(world.box_queries()[0], goal=Pose2(x_m=6.0 - off_m, y_m=3.0, yaw_rad=radians(off_deg)))
    plan = Plan(status="exact", reason="", waypoints=(query.start,) * n_waypoints, sides=(0,) * n_waypoints)

    assert (plan_fault(query, plan) == "") == is_fine


def test_a_path_of_the_trunk_needs_no_sides() -> None:
    query = parts_in(FakeWorld(), make_scenario()).walker.query_behind("rear")

    assert plan_fault(query, straight_plan(query)) == ""
    assert plan_fault(query, replace(straight_plan(query), waypoints=())) == "it has no waypoints"


def test_a_better_path_begins_at_the_robot_and_ends_with_the_last_stretch() -> None:
    parts, waypoints = detoured()

    better = better_path(parts.planner, waypoints)

    assert better[0] == parts.actor.trunk()
    assert better[-len(STRETCH) :] == STRETCH
    assert path_length_m(better, CIRCLE_M) < path_length_m(waypoints, CIRCLE_M) - 0.4
    assert parts.planner.n_better_paths == 1


def test_a_revision_that_saves_too_little_is_not_taken_and_not_counted() -> None:
    parts, _ = detoured()
    straight = straight_plan(parts.world.queries()[0]).waypoints

    assert better_path(parts.planner, straight + STRETCH) == ()
    assert parts.planner.n_better_paths == 0


def test_the_last_stretch_is_no_part_of_what_a_revision_may_save() -> None:
    parts, waypoints = detoured()
    ahead_m = path_length_m(better_path(parts.planner, waypoints)[: -len(STRETCH)], CIRCLE_M)
    for left_m, expected in ((ahead_m + 0.05, False), (ahead_m + 0.15, True)):
        parts, waypoints = detoured()
        travelled_m = path_length_m(waypoints, CIRCLE_M) - path_length_m(STRETCH, CIRCLE_M) - left_m
        assert bool(better_path(parts.planner, waypoints, travelled_m)) == expected


def test_revisions_are_waited_for_in_order_after_the_first_gait_cycle_only() -> None:
    asked: list[int] = []

    def better(query: PlanQuery, revision: int) -> Plan:
        asked.append(revision)
        return detour(query)

    parts, waypoints = detoured()
    parts.world.better = better

    assert better_path(parts.planner, waypoints, travelled_m=0.0) == ()
    assert asked == []
    assert [better_path(parts.planner, waypoints) for _ in range(5)] == [()] * 5
    assert asked == [1, 2, 3]


@pytest.mark.parametrize("by", ["forget", "cancel", "another plan"])
def test_no_revision_of_an_old_plan_is_waited_for(by: str) -> None:
    parts, waypoints = detoured()

    if by == "forget":
        parts.planner.forget_better_paths()
    elif by == "cancel":
        parts.planner.cancel()
    else:
        parts.route.way_to_push(parts.actor.box(), parts.walker.query_behind, "the way")
        parts.planner.ask(parts.world.box_queries()[0], "the path of the box")

    assert better_path(parts.planner, waypoints) == ()
    assert parts.world.n_cancelled == (by == "cancel")


def test_a_revision_that_cannot_be_followed_is_the_fault_of_a_peer() -> None:
    parts, waypoints = detoured()
    parts.world.better = lambda _query, _revision: Plan(status="exact", reason="", length_m=1.0)

    with pytest.raises(PeerError, match="revision 1 of the way: expected a plan that can be followed"):
        better_path(parts.planner, waypoints)


def test_a_path_that_is_given_up_is_counted_and_told() -> None:
    parts, _ = detoured(room=Room(size_m=(12.0, 6.0), obstacles=(ASIDE,)))

    parts.planner.give_up("the robot", 0)

    assert parts.planner.n_replans == 1
    assert parts.world.told[-1] == (
        "giving up a path",
        None,
        "of the robot; appeared: room.obstacles[0] at 1.6 s",
    )


@pytest.mark.parametrize(("obstacles", "appeared"), [((), ""), ((ASIDE,), "; appeared: room.obstacles[0] at 1.6 s")])
def test_without_a_path_it_is_said_what_the_planner_answered_and_what_has_appeared(
    obstacles: tuple[Rectangle, ...], appeared: str
) -> None:
    parts, _ = detoured(room=Room(size_m=(12.0, 6.0), obstacles=obstacles))

    query = parts.walker.query_behind("rear")
    error = parts.planner.no_path("the way", query, Plan(status="failed", reason="nothing found"))

    assert error.reason == "no_path"
    assert str(error) == f"the way: the planner's answer is failed: nothing found{appeared}"
    assert "`planning.margin_m` (0.1 m), with which a walk needs passages of 0.88 m" in error.remedy
    assert "`planning.max_iterations`" in error.remedy
