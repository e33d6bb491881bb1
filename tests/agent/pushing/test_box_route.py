"""Which stages the box is pushed along next, and how the robot comes to them."""

from collections.abc import Callable
from math import degrees

import pytest
from msgspec.structs import replace

from agent_proc.endings import MissionEndedError
from agent_proc.mission.mission import run_mission
from agent_proc.policies.scripted import ScriptedPolicy
from agent_proc.pushing.stage import Stage
from legpush.errors import PeerError
from legpush.messages.planning import BoxPathQuery, Plan, PlanQuery, TrunkPathQuery
from legpush.messages.stepping import Follow, Push
from legpush.scene.reference import Arcs, Left, Straight, reference_curve
from legpush.scene.scenario import Goal, PoseDeg, PushSettings, Rectangle, Room
from tests.agent.fake_world import FakeWorld, make_scenario, scenario_at_station, straight_plan
from tests.agent.parts import Parts, parts_in
from tests.agent.pushing.paths import AXLE_M, along, line
from tests.robots import ROBOT

AHEAD = Arcs(radius_m=1.0, segments=(Straight(length_m=1.0),))
CRATE = Rectangle(x_min_m=6.6, x_max_m=6.8, y_min_m=3.0, y_max_m=3.4, appears_at_s=2.0)
"""In the way of the box, after one push."""
BESIDE = replace(CRATE, y_min_m=5.0, y_max_m=5.4)
ONE_PUSH = Push(w1=0.5, w2=0.5, leg="FL", depth_m=0.05)


def at_faces(*sides: int) -> Callable[[PlanQuery], Plan]:
    """A planner whose path of the box is pushed at the first of these sides that the query has."""

    def plan(query: PlanQuery) -> Plan:
        found = straight_plan(query)
        if not isinstance(query, BoxPathQuery):
            return found
        return replace(found, sides=(min(sides[0], len(query.sides) - 1),) * len(found.waypoints))

    return plan


def refusing(
    kind: type[BoxPathQuery] | type[TrunkPathQuery], status: str = "failed", n_times: int = 1000
) -> Callable[[PlanQuery], Plan]:
    """A planner that finds nothing for the first queries of one kind."""
    left = [n_times]

    def plan(query: PlanQuery) -> Plan:
        if isinstance(query, kind) and left[0]:
            left[0] -= 1
            return Plan(status=status, reason="nothing found")  # type: ignore[arg-type]
        return straight_plan(query)

    return plan


def test_a_reference_is_refused_for_a_guess_but_not_if_the_box_can_be_calibrated_first() -> None:
    reference = Arcs(radius_m=0.5, segments=(Straight(length_m=0.5), Left(angle_deg=60.0), Straight(length_m=0.5)))
    scenario = scenario_at_station()
    x_m, y_m, yaw_rad = reference_curve(reference, scenario.box.pose.pose())[-1].tolist()
    goal = Goal(pose=PoseDeg(x_m=x_m, y_m=y_m, yaw_deg=degrees(yaw_rad)))
    results = []
    for n_pushes in (0, 6):
        pushing = PushSettings(calibration_pushes=n_pushes)
        asked = replace(scenario, reference=reference, goal=goal, pushing=pushing)
        results.append(run_mission(FakeWorld(turn_scale=1.5), asked, 3, ScriptedPolicy()))

    assert (results[0].reason, results[0].n_push_cycles) == ("no_path", 0)
    assert results[1].success, results[1].detail


def pushed_once(*obstacles: Rectangle) -> tuple[Parts, list[Stage]]:
    """A robot on its way along the stages of the box, after one push, when these obstacles have appeared."""
    scenario = replace(scenario_at_station(), room=Room(size_m=(12.0, 6.0), obstacles=obstacles))
    parts = parts_in(FakeWorld(), scenario)
    stages = parts.route.come_to_push()
    parts.pushes.push(ONE_PUSH, learn=False)
    assert parts.actor.n_appeared() == len(obstacles)
    return parts, stages


def test_a_robot_that_stands_at_the_first_face_needs_no_way() -> None:
    parts = parts_in(FakeWorld(), scenario_at_station())

    stages, plan = parts.route.way_to_push(parts.actor.box(), parts.walker.query_behind, "the way")

    assert plan is None
    assert [stage.face for stage in stages] == ["rear"]
    (query,) = parts.world.box_queries()
    assert query.present_side == 0
    assert parts.world.queries() == []


@pytest.mark.parametrize(("side", "face"), [(0, "rear"), (1, "right"), (3, "left")])
def test_the_robot_comes_to_the_face_where_the_path_of_the_box_begins(side: int, face: str) -> None:
    parts = parts_in(FakeWorld(planner=at_faces(side)), make_scenario())

    stages = parts.route.come_to_push()

    assert [stage.face for stage in stages] == [face]
    assert parts.actor.standing_at() == face


def test_a_face_that_the_robot_cannot_reach_is_not_asked_for_again() -> None:
    parts = parts_in(FakeWorld(planner=refusing(TrunkPathQuery, n_times=1)), make_scenario())

    stages, plan = parts.route.way_to_push(parts.actor.box(), parts.walker.query_behind, "the way")

    assert [len(query.sides) for query in parts.world.box_queries()] == [4, 3]
    assert stages[0].face == "right"
    assert plan is not None
    assert plan.status == "exact"


def test_without_a_face_that_the_robot_can_reach_the_mission_ends() -> None:
    parts = parts_in(FakeWorld(planner=refusing(TrunkPathQuery)), make_scenario())

    with pytest.raises(
        MissionEndedError, match="the way behind the box, to its rear face: the planner's answer is failed"
    ) as ended:
        parts.route.come_to_push()
    assert ended.value.reason == "no_path"
    assert len(parts.world.box_queries()) == 4


def test_a_robot_at_another_face_backs_off_before_it_asks_for_the_way() -> None:
    parts = parts_in(FakeWorld(planner=at_faces(1)), scenario_at_station())

    parts.route.come_to_push()

    assert parts.actor.standing_at() == "right"
    phases = [phase for phase, _, _ in parts.world.told]
    assert phases.index("backing off") < phases.index("approaching")
    assert parts.world.queries()[0].start.x_m < scenario_at_station().start.x_m - 0.1


def test_without_a_path_of_the_box_the_mission_ends() -> None:
    parts = parts_in(FakeWorld(planner=refusing(BoxPathQuery)), make_scenario())

    with pytest.raises(MissionEndedError, match="the path of the box: the planner's answer is failed") as ended:
        parts.route.come_to_push()
    assert ended.value.reason == "no_path"
    assert len(parts.world.box_queries()) == 1


def test_a_path_of_the_box_that_cannot_be_followed_is_the_fault_of_a_peer() -> None:
    parts = parts_in(FakeWorld(planner=lambda query: replace(straight_plan(query), sides=())), make_scenario())

    with pytest.raises(PeerError, match="the path of the box: expected a plan that can be followed"):
        parts.route.come_to_push()


def test_a_box_that_was_pushed_too_near_to_something_may_go_on_closer_to_obstacles() -> None:
    parts = parts_in(FakeWorld(planner=refusing(BoxPathQuery, "invalid", 1)), scenario_at_station())
    parts.pushes.push(ONE_PUSH, learn=False)

    parts.route.come_to_push()

    first, closer = parts.world.box_queries()
    assert first.clearance_m > closer.clearance_m == 0.0
    assert first.walk_clearance_m > closer.walk_clearance_m == ROBOT.stance.body_width_m / 2
    assert replace(closer, clearance_m=first.clearance_m, walk_clearance_m=first.walk_clearance_m) == first


def test_a_box_that_was_not_pushed_yet_may_not() -> None:
    parts = parts_in(FakeWorld(planner=refusing(BoxPathQuery, "invalid", 1)), scenario_at_station())

    with pytest.raises(MissionEndedError, match="the planner's answer is invalid"):
        parts.route.come_to_push()


def test_stages_are_free_until_something_appears_in_them() -> None:
    blocked, stages = pushed_once(CRATE)
    beside, _ = pushed_once(BESIDE)

    assert beside.route.is_free(stages)
    assert not blocked.route.is_free(stages)
    assert not blocked.route.is_free(stages, 0.3)


def test_what_the_box_has_passed_is_in_the_way_of_a_later_stage_only() -> None:
    passed, _ = pushed_once(replace(CRATE, x_min_m=3.8, x_max_m=4.0))
    stage = Stage("rear", line("rear", 2.0)[0], AXLE_M)
    before = Stage("rear", tuple(replace(pose, x_m=pose.x_m - 1.5) for pose in line("rear", 1.0)[0]), AXLE_M)

    assert not passed.route.is_free([before])
    assert not passed.route.is_free([stage, before], 0.9)
    assert passed.route.is_free([before, stage], 0.9)


def test_what_stood_there_when_the_path_was_planned_is_left_to_the_plan() -> None:
    parts, stages = pushed_once(CRATE)

    parts.route.come_to_push()

    assert parts.route.is_free(stages)


def test_what_is_not_in_the_way_is_looked_at_once() -> None:
    parts, stages = pushed_once(BESIDE)
    assert parts.route.is_free(stages)

    across = Stage("rear", tuple(replace(pose, y_m=5.2) for pose in line("rear", 1.0)[0]), AXLE_M)

    assert parts.route.is_free([across])


def test_the_stages_of_a_reference_have_to_be_free() -> None:
    (blocked, stages), (beside, _) = pushed_once(CRATE), pushed_once(BESIDE)

    beside.route.require_free(stages)
    with pytest.raises(
        MissionEndedError, match=r"the reference is not free any more; appeared: room.obstacles\[0\] at 3.0 s"
    ) as ended:
        blocked.route.require_free(stages)
    assert ended.value.reason == "no_path"


def test_stages_that_are_given_up_are_counted_and_told() -> None:
    parts, _ = pushed_once(CRATE)

    parts.route.give_up()

    assert parts.planner.n_replans == 1
    assert parts.world.told[-1] == (
        "giving up a path",
        None,
        "of the box; appeared: room.obstacles[0] at 3.0 s",
    )


def test_a_reference_is_pushed_along_first_and_paths_are_planned_after_it() -> None:
    parts = parts_in(FakeWorld(), along(AHEAD))

    (stage,) = parts.route.begin_reference()

    assert parts.world.box_queries() == []
    assert stage.face == "rear"
    assert stage.length_m == pytest.approx(1.0)
    assert parts.route.reference is None
    parts.route.come_to_push()
    assert len(parts.world.box_queries()) == 1


def test_a_reference_begins_at_the_nominal_pose_of_the_box_behind_which_the_robot_walks() -> None:
    parts = parts_in(FakeWorld(box_offset=(0.03, 0.05, 0.0)), make_scenario(reference=AHEAD))

    (stage,) = parts.route.begin_reference()

    assert stage.pose(0.0).xy() == pytest.approx((6.0, 3.0))
    assert parts.actor.standing_at() == "rear"
    assert len(parts.world.motions(Follow)) == 1


def test_a_reference_is_pushed_at_the_rear_face_or_not_at_all() -> None:
    parts = parts_in(FakeWorld(planner=refusing(TrunkPathQuery)), make_scenario(reference=AHEAD))

    with pytest.raises(MissionEndedError, match="the way behind the box"):
        parts.route.begin_reference()
    assert len(parts.world.queries()) == 1


def test_a_reference_that_is_no_longer_free_is_not_begun() -> None:
    scenario = replace(along(AHEAD), room=Room(size_m=(12.0, 6.0), obstacles=(CRATE,)))
    parts = parts_in(FakeWorld(), scenario)
    parts.pushes.push(ONE_PUSH, learn=False)

    with pytest.raises(MissionEndedError, match="the reference is not free any more"):
        parts.route.begin_reference()
