"""A mission whose world changes: what appears in the way is gone around, what does not is left alone."""

from collections.abc import Callable, Iterable
from itertools import groupby

import pytest
from msgspec.structs import replace

from agent_proc.endings import MissionResult
from agent_proc.frames.poses import box_error
from agent_proc.mission.mission import run_mission
from agent_proc.policies.scripted import ScriptedPolicy
from legpush.errors import PeerError
from legpush.geometry import Pose2, distance_m
from legpush.history.steps import StepRecord
from legpush.messages.planning import BoxPathQuery, Plan, PlanQuery
from legpush.messages.stepping import Appearance, Follow, Motion, Outcome, Push, Walk
from legpush.scene.reference import Arcs, Straight
from legpush.scene.scenario import Goal, PoseDeg, PushSettings, Rectangle, Room, Scenario
from tests.agent.fake_world import FakeWorld, make_scenario, scenario_at_station, straight_plan
from tests.distances import clearance_at

WALKING_S = 2.0
"""The robot has walked 0.8 m of its way to the box."""
APPROACHING_S = 7.0
PUSHING_S = 10.0
"""Of a robot that stands at the box from the start."""
GATE = Rectangle(x_min_m=3.2, x_max_m=3.4, y_min_m=2.0, y_max_m=4.0, appears_at_s=WALKING_S)
"""Across the straight way to the box."""
ASIDE = replace(GATE, y_min_m=0.0, y_max_m=1.0)


def run(world: FakeWorld, scenario: Scenario) -> MissionResult:
    return run_mission(world, scenario, 7, ScriptedPolicy(), tell=world.tell)


def with_obstacles(scenario: Scenario, *obstacles: Rectangle) -> Scenario:
    return replace(scenario, room=replace(scenario.room, obstacles=obstacles))


def knows(query: PlanQuery, obstacle: Rectangle) -> bool:
    """Whether an obstacle is in the map of a query."""
    x_m, y_m = (obstacle.x_min_m + obstacle.x_max_m) / 2, (obstacle.y_min_m + obstacle.y_max_m) / 2
    return clearance_at(query.grid, Pose2(x_m=x_m, y_m=y_m, yaw_rad=0.0)) == 0.0


def moves(world: FakeWorld) -> list[Motion]:
    """All motions but the reset."""
    motions = [record.motion for record in world.records if isinstance(record, StepRecord)]
    assert len(motions) > 10
    return motions[1:]


def around(obstacle: Rectangle) -> Callable[[PlanQuery], Plan]:
    """A planner that goes by 1 m above an obstacle that it knows, in two straight lines."""

    def plan(query: PlanQuery) -> Plan:
        if isinstance(query, BoxPathQuery) or not knows(query, obstacle):
            return straight_plan(query)
        corner = Pose2(x_m=obstacle.x_min_m, y_m=obstacle.y_max_m + 1.0, yaw_rad=0.0)
        there, on = straight_plan(replace(query, goal=corner)), straight_plan(replace(query, start=corner))
        return replace(on, waypoints=there.waypoints + on.waypoints)

    return plan


def blocked_by(obstacle: Rectangle, kinds: Iterable[type] = (object,)) -> Callable[[PlanQuery], Plan]:
    """A planner that knows no way once there is this obstacle."""

    def plan(query: PlanQuery) -> Plan:
        if isinstance(query, tuple(kinds)) and knows(query, obstacle):
            return Plan(status="failed", reason="no way within the budget")
        return straight_plan(query)

    return plan


# -- walking ---------------------------------------------------------------------------------------------------------


def test_a_robot_asks_for_a_new_way_from_where_it_is_when_something_appears_in_it() -> None:
    world, scenario = FakeWorld(planner=around(GATE)), with_obstacles(make_scenario(), GATE)

    result = run(world, scenario)

    assert (result.success, result.n_replans) == (True, 1)
    first, second, *_ = world.queries()
    assert (knows(first, GATE), knows(second, GATE)) == (False, True)
    assert second.goal == first.goal
    assert second.start.x_m - first.start.x_m == pytest.approx(2 * world.simulator.walk_stride_m, abs=0.01)
    follows = world.motions(Follow)
    assert isinstance(follows[1], Follow)
    assert distance_m(follows[1].waypoints[0], second.start) < 1e-9
    assert ("giving up a path", None, "of the robot; appeared: room.obstacles[0] at 3.2 s") in world.told


def test_the_first_plan_knows_nothing_of_what_is_yet_to_appear() -> None:
    always = Rectangle(x_min_m=0.0, x_max_m=0.5, y_min_m=0.0, y_max_m=0.5)
    world, without = FakeWorld(planner=around(GATE)), FakeWorld()

    run(world, with_obstacles(make_scenario(), always, GATE))
    run(without, with_obstacles(make_scenario(), always))

    assert world.queries()[0] == without.queries()[0]
    assert world.box_queries()[0] == without.box_queries()[0]


def test_a_way_that_is_left_free_is_kept_and_later_plans_know_what_has_appeared() -> None:
    world, without = FakeWorld(), FakeWorld()

    result = run(world, with_obstacles(make_scenario(), ASIDE))
    run(without, make_scenario())

    assert (result.success, result.n_replans) == (True, 0)
    assert moves(world) == moves(without)
    assert [knows(query, ASIDE) for query in world.queries()] == [False, True]
    assert [knows(query, ASIDE) for query in world.box_queries()] == [False, True]


def test_an_approach_is_planned_anew_as_well() -> None:
    gate = replace(GATE, x_min_m=4.6, x_max_m=4.7, appears_at_s=APPROACHING_S)
    world, scenario = FakeWorld(planner=around(gate)), with_obstacles(make_scenario(), gate)

    result = run(world, scenario)

    assert (result.success, result.n_replans) == (True, 1)
    assert [knows(query, gate) for query in world.queries()] == [False, False, True]
    assert [knows(query, gate) for query in world.box_queries()] == [False, False, True]


def test_a_robot_without_space_to_turn_steps_back_before_it_asks_for_a_new_way() -> None:
    beside = Rectangle(x_min_m=5.2, x_max_m=5.3, y_min_m=3.39, y_max_m=3.6, appears_at_s=13.5)
    world, scenario = FakeWorld(), with_obstacles(make_scenario(), beside)

    result = run(world, scenario)

    assert (result.success, result.n_replans) == (True, 1)
    phases = [phase for phase, _ in groupby(phase for phase, _, _ in world.told)]
    back = phases.index("backing off")
    assert phases[back - 2 : back + 3] == ["approaching", "giving up a path", "backing off", "planning", "approaching"]
    assert world.queries()[-1].start.x_m < 5.0


def test_a_robot_that_is_cut_off_ends_its_mission_without_a_path_and_says_since_when() -> None:
    world = FakeWorld(planner=blocked_by(GATE))

    result = run(world, with_obstacles(make_scenario(), GATE))

    assert (result.success, result.reason, result.n_replans) == (False, "no_path", 1)
    assert result.detail == (
        "the path of the box: the planner's answer is failed: no way within the budget; "
        "appeared: room.obstacles[0] at 3.2 s"
    )
    assert isinstance(world.records[-2][0], Walk)


# -- pushing ---------------------------------------------------------------------------------------------------------


def test_another_path_of_the_box_is_planned_when_something_appears_in_it() -> None:
    crate = Rectangle(x_min_m=6.6, x_max_m=6.8, y_min_m=3.0, y_max_m=3.4, appears_at_s=PUSHING_S)
    world, scenario = FakeWorld(), with_obstacles(scenario_at_station(), crate)

    result = run(world, scenario)

    assert (result.success, result.n_replans) == (True, 1)
    first, second = world.box_queries()
    assert (knows(first, crate), knows(second, crate)) == (False, True)
    assert second.start.x_m > first.start.x_m + 0.05
    assert second.present_side == 0


def test_a_path_of_the_box_is_kept_when_what_appears_is_beside_it() -> None:
    beside = Rectangle(x_min_m=6.6, x_max_m=6.8, y_min_m=3.4, y_max_m=3.6, appears_at_s=PUSHING_S)
    world, without = FakeWorld(), FakeWorld()

    result = run(world, with_obstacles(scenario_at_station(), beside))
    run(without, scenario_at_station())

    assert (result.success, result.n_replans) == (True, 0)
    assert len(world.box_queries()) == 1
    assert moves(world) == moves(without)


def test_a_box_that_is_cut_off_from_its_goal_ends_the_mission_without_a_path() -> None:
    crate = Rectangle(x_min_m=6.6, x_max_m=6.8, y_min_m=3.0, y_max_m=3.4, appears_at_s=PUSHING_S)
    world = FakeWorld(planner=blocked_by(crate))

    result = run(world, with_obstacles(scenario_at_station(), crate))

    assert (result.reason, result.n_replans) == ("no_path", 1)
    assert result.detail.endswith("appeared: room.obstacles[0] at 12.0 s")
    assert result.n_push_cycles == len(world.motions(Push)) == 4


def test_an_open_loop_does_not_look() -> None:
    crate = Rectangle(x_min_m=6.6, x_max_m=6.8, y_min_m=3.0, y_max_m=3.4, appears_at_s=PUSHING_S)
    scenario = replace(with_obstacles(scenario_at_station(), crate), pushing=PushSettings(composition="open_loop"))
    world = FakeWorld()

    assert run(world, scenario).n_replans == 0
    assert len(world.box_queries()) == 1


@pytest.mark.parametrize("appears_at_s", [WALKING_S, 20.0])
def test_there_is_no_other_way_than_along_a_reference(appears_at_s: float) -> None:
    crate = Rectangle(x_min_m=7.4, x_max_m=7.6, y_min_m=3.0, y_max_m=3.4, appears_at_s=appears_at_s)
    scenario = make_scenario(
        room=Room(size_m=(12.0, 6.0), obstacles=(crate,)),
        goal=Goal(pose=PoseDeg(x_m=8.0, y_m=3.0, yaw_deg=0.0)),
        reference=Arcs(radius_m=1.0, segments=(Straight(length_m=2.0),)),
    )
    world = FakeWorld()

    result = run(world, scenario)

    assert result.reason == "no_path"
    assert result.detail.startswith("the reference is not free any more; appeared: room.obstacles[0] at ")
    assert bool(world.motions(Push)) == (appears_at_s > WALKING_S)


def test_a_calibration_ends_when_something_appears() -> None:
    beside = Rectangle(x_min_m=6.6, x_max_m=6.8, y_min_m=5.0, y_max_m=5.6, appears_at_s=PUSHING_S)
    scenario = replace(scenario_at_station(), pushing=PushSettings(calibration_pushes=8))
    world, without = FakeWorld(), FakeWorld()

    run(world, with_obstacles(scenario, beside))
    run(without, scenario)

    told = [[detail for phase, _, detail in each.told if phase == "calibrating"] for each in (world, without)]
    assert [len(details) for details in told] == [4, 8]


# -- answers of the world --------------------------------------------------------------------------------------------


def test_a_mission_with_new_ways_is_answered_from_its_record_as_it_was() -> None:
    crate = Rectangle(x_min_m=6.6, x_max_m=6.8, y_min_m=3.0, y_max_m=3.4, appears_at_s=16.0)
    scenario = with_obstacles(make_scenario(), GATE, crate)
    first = FakeWorld(planner=around(GATE))
    result = run(first, scenario)

    class Replay(FakeWorld):
        """Answers in the recorded order, and checks what is asked."""

        def step(self, motion: Motion, *, with_trace: bool = False) -> Outcome:
            asked, outcome = left.pop(0)
            assert asked == motion
            assert isinstance(outcome, Outcome)
            return outcome

        def plan(self, query: PlanQuery) -> Plan:
            asked, plan = left.pop(0)
            assert asked == query
            assert isinstance(plan, Plan)
            return plan

    left = list(first.records)

    assert run(Replay(), scenario) == result
    assert result.n_replans == 2
    assert box_error(first.records[-1][1].world, scenario).within(scenario.goal)  # type: ignore[union-attr]
    assert left == []


def test_a_simulator_that_invents_obstacles_is_an_error() -> None:
    class Inventive(FakeWorld):
        def step(self, motion: Motion, *, with_trace: bool = False) -> Outcome:
            outcome = super().step(motion, with_trace=with_trace)
            return replace(outcome, world=replace(outcome.world, appeared=(Appearance(obstacle=3, tick=0),)))

    with pytest.raises(PeerError, match=r"an obstacle that appears later \(0\), got 3"):
        run(Inventive(), with_obstacles(make_scenario(), GATE))
