"""The mission from reset to report, in a world without physics."""

from collections.abc import Mapping
from math import cos, hypot, pi, radians, sin

import pytest
from msgspec.structs import replace

from agent_proc.endings import MissionResult
from agent_proc.frames.poses import box_error
from agent_proc.frames.push_view import PushView
from agent_proc.mission.mission import run_mission
from agent_proc.policies.scripted import ScriptedPolicy
from legpush.geometry import Pose2
from legpush.messages.planning import Plan, PlanQuery
from legpush.messages.poses import planar_pose
from legpush.messages.stepping import Follow, Motion, Outcome, Push, Reset, Walk, WorldState
from legpush.realism.settings import Randomization
from legpush.scene.occupancy import clearance_m
from legpush.scene.scenario import Box, Goal, MissionSettings, PoseDeg, Rectangle, Room, Scenario
from legpush.scene.station import stand_off, station
from tests.agent.fake_world import FakeWorld, make_scenario, scenario_at_station, straight_plan
from tests.distances import clearance_at
from tests.robots import ROBOT


def run(world: FakeWorld, scenario: Scenario) -> MissionResult:
    return run_mission(world, scenario, 7, ScriptedPolicy(), tell=world.tell)


def last_state(world: FakeWorld) -> WorldState:
    return world.records[-1][1].world  # type: ignore[union-attr]


def always_push(leg_depth_m: float = 0.0) -> object:
    """A policy that is never done."""

    class Always:
        def decide(self, _view: PushView) -> Push | None:
            return Push(w1=0.5, w2=0.5, leg="FL", depth_m=leg_depth_m)

    return Always()


def test_a_mission_walks_hands_over_approaches_and_pushes_the_box_to_its_goal() -> None:
    world, scenario = FakeWorld(box_offset=(0.04, -0.05, radians(4.0))), make_scenario()

    result = run(world, scenario)

    assert (result.success, result.reason) == (True, "success")
    assert world.motions(Reset) == [Reset(scenario=scenario, seed=7)]
    assert len(world.queries()) == len(world.motions(Follow)) == 2
    assert result.n_push_cycles == len(world.motions(Push)) > 5
    assert box_error(last_state(world), scenario).within(scenario.goal)
    phases = list(dict.fromkeys(phase for phase, _, _ in world.told))
    assert phases == ["planning", "walking", "approaching", "pushing"]
    assert all(fraction is None or 0.0 <= fraction <= 1.0 for _, fraction, _ in world.told)


def test_the_hand_over_happens_at_the_first_gait_cycle_within_the_distance() -> None:
    scenario = make_scenario(mission=MissionSettings(handover_distance_m=2.5))
    world = FakeWorld()

    result = run(world, scenario)

    assert result.handover_distance_m is not None
    assert 2.5 - world.simulator.walk_stride_m < result.handover_distance_m <= 2.5


def test_the_second_plan_starts_where_the_robot_is_and_leads_behind_the_measured_box() -> None:
    world, scenario = FakeWorld(box_offset=(0.05, 0.05, radians(5.0))), make_scenario()

    run(world, scenario)

    nominal, measured = world.queries()
    box = Pose2(x_m=6.05, y_m=3.05, yaw_rad=radians(5.0))
    assert nominal.start == Pose2(x_m=1.5, y_m=3.0, yaw_rad=0.0)
    assert nominal.goal == stand_off(scenario, scenario.box, Pose2(x_m=6.0, y_m=3.0, yaw_rad=0.0))
    assert measured.start.x_m > 2.0
    assert measured.goal.x_m == pytest.approx(stand_off(scenario, scenario.box, box).x_m)
    assert measured.goal.yaw_rad == pytest.approx(box.yaw_rad)
    approach = world.motions(Follow)[1]
    assert isinstance(approach, Follow)
    end, place = approach.waypoints[-1], station(ROBOT, scenario.box, box)
    assert hypot(end.x_m - place.x_m, end.y_m - place.y_m) < 1e-9


def test_the_box_is_an_obstacle_of_both_plans_and_the_goals_are_clear_of_it() -> None:
    scenario = make_scenario(randomization=Randomization(box_xy_m=0.05, box_yaw_deg=5.0))
    world = FakeWorld(box_offset=(-0.05, 0.05, radians(5.0)))

    run(world, scenario)

    nominal, measured = world.queries()[:2]
    assert sum(nominal.grid.cells) > sum(measured.grid.cells) > 0
    for query in (nominal, measured):
        assert clearance_at(query.grid, Pose2(x_m=6.0, y_m=3.0, yaw_rad=0.0)) == 0.0
        assert clearance_at(query.grid, query.goal) > query.clearance_m == clearance_m(scenario)


def test_a_wide_margin_moves_the_stand_off_back_from_the_box() -> None:
    scenario = make_scenario()
    wide = replace(scenario, planning=replace(scenario.planning, margin_m=0.5))
    box = scenario.box.pose.pose()

    assert stand_off(wide, scenario.box, box).x_m < stand_off(scenario, scenario.box, box).x_m


def test_a_robot_that_came_close_to_a_wall_keeps_the_clearance_that_it_has() -> None:
    wall = Rectangle(x_min_m=0.0, x_max_m=12.0, y_min_m=0.0, y_max_m=2.6)
    scenario = make_scenario(
        (3.6, 3.0, 0.0),
        room=Room(size_m=(12.0, 6.0), obstacles=(wall,)),
        mission=MissionSettings(handover_distance_m=3.0),
    )
    world = FakeWorld()

    run(world, scenario)

    (query,) = world.queries()
    assert query.clearance_m == pytest.approx(0.4, abs=0.01)
    assert query.clearance_m < clearance_m(scenario)


def test_a_robot_at_the_station_pushes_without_a_plan() -> None:
    world = FakeWorld()

    result = run(world, scenario_at_station())

    assert result.success
    assert result.handover_distance_m == pytest.approx(0.618, abs=0.001)
    assert world.queries() == []
    assert world.motions(Walk) == []


def test_a_robot_that_starts_near_the_box_is_handed_over_at_once() -> None:
    world = FakeWorld()

    result = run(world, make_scenario((4.0, 2.0, 30.0)))

    assert result.success
    assert len(world.queries()) == 1
    assert result.handover_distance_m == pytest.approx(hypot(2.0, 1.0))


@pytest.mark.parametrize("status", ["approximate", "failed", "invalid"])
def test_any_plan_but_an_exact_one_ends_the_mission_and_is_not_walked(status: str) -> None:
    def planner(query: PlanQuery) -> Plan:
        return replace(straight_plan(query), status=status, reason="walled in")

    world = FakeWorld(planner=planner)

    result = run(world, make_scenario())

    assert (result.success, result.reason, result.handover_distance_m) == (False, "no_path", None)
    assert status in result.detail
    assert "walled in" in result.detail
    assert world.motions(Follow) == []


@pytest.mark.parametrize("kind", [Walk, Push])
def test_a_fall_ends_the_mission_at_once(kind: type[Motion]) -> None:
    world = FakeWorld(falls_in=lambda motion, n: isinstance(motion, kind) and n == 3)

    result = run(world, make_scenario())

    assert (result.success, result.reason) == (False, "fell")
    assert len(world.motions(kind)) == 3
    assert isinstance(world.records[-1][0], kind)


def test_a_fall_with_the_box_at_its_goal_is_no_success() -> None:
    at_goal = replace(scenario_at_station(), goal=Goal(pose=PoseDeg(x_m=6.03, y_m=3.0, yaw_deg=0.0)))
    world = FakeWorld(falls_in=lambda motion, _: isinstance(motion, Push))

    result = run_mission(world, at_goal, 0, always_push(0.03))  # type: ignore[arg-type]

    assert box_error(last_state(world), at_goal).within(at_goal.goal)
    assert (result.success, result.reason) == (False, "fell")


def test_a_box_that_the_robot_cannot_push_ends_the_mission_before_it_walks() -> None:
    scenario = make_scenario()
    heavy = replace(scenario, box=replace(scenario.box, mass_kg=80.0))
    world = FakeWorld()

    result = run(world, heavy)

    assert (result.success, result.reason) == (False, "too_heavy")
    assert "takes at least" in result.detail
    assert "`box.mass_kg`" in result.remedy
    assert len(world.motions(Reset)) == 1
    assert not world.motions(Walk) + world.motions(Push) + world.queries()


def test_a_heavy_box_that_is_at_its_goal_needs_no_push() -> None:
    scenario = make_scenario()
    there = replace(
        scenario, box=replace(scenario.box, mass_kg=80.0), goal=replace(scenario.goal, pose=scenario.box.pose)
    )

    assert run(FakeWorld(), there).reason == "success"


def test_a_box_that_tips_over_ends_the_mission_even_at_its_goal() -> None:
    class TippingWorld(FakeWorld):
        def step(self, motion: Motion, *, with_trace: bool = False) -> Outcome:
            outcome = super().step(motion, with_trace=with_trace)
            if isinstance(motion, Push):
                lying = replace(outcome.world.box, orientation_wxyz=(cos(pi / 8), 0.0, sin(pi / 8), 0.0))
                outcome = replace(outcome, world=replace(outcome.world, box=lying))
            return outcome

    result = run(TippingWorld(), scenario_at_station())

    assert (result.success, result.reason, result.n_push_cycles) == (False, "box_tipped", 1)
    assert "leans by 45°" in result.detail


def test_a_mission_that_is_answered_from_its_record_asks_the_same_again() -> None:
    scenario = make_scenario(box=Box(pose=PoseDeg(x_m=6.0, y_m=3.0, yaw_deg=10.0)))
    first = FakeWorld(box_offset=(0.03, 0.02, -0.05))
    result = run(first, scenario)

    class Replay:
        """Answers in the recorded order, and checks what is asked."""

        def __init__(self) -> None:
            self.left = list(first.records)

        def step(self, motion: Motion, *, with_trace: bool = False) -> Outcome:
            asked, outcome = self.left.pop(0)
            assert asked == motion
            assert isinstance(outcome, Outcome)
            return outcome

        def plan(self, query: PlanQuery) -> Plan:
            asked, plan = self.left.pop(0)
            assert asked == query
            assert isinstance(plan, Plan)
            return plan

        def revision(self, revision: int) -> Plan:
            raise AssertionError(revision)

        def cancel_plan(self) -> None:
            pass

        def tell_reward(self, terms: Mapping[str, float]) -> None:
            pass

    replay = Replay()

    assert run_mission(replay, scenario, 7, ScriptedPolicy()) == result
    assert replay.left == []


def test_the_robot_ends_at_the_station_of_the_box() -> None:
    world, scenario = FakeWorld(), make_scenario()

    run(world, scenario)

    state = last_state(world)
    place, trunk = station(ROBOT, scenario.box, planar_pose(state.box)), planar_pose(state.trunk)
    assert hypot(place.x_m - trunk.x_m, place.y_m - trunk.y_m) < 1e-9
