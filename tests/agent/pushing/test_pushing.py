"""Pushing the box to its goal, in missions whose world moves it as the push model says."""

import pytest
from msgspec.structs import replace

from agent_proc.frames.poses import box_error
from agent_proc.frames.push_view import PushView
from agent_proc.mission.mission import run_mission
from agent_proc.policies.registry import make_policy
from agent_proc.policies.scripted import ScriptedPolicy
from agent_proc.pushing.pushing import AIM_M, MAX_BETTER, MAX_PATHS, STUCK_SHARE
from agent_proc.reporting.mission_record import read_record
from agent_proc.reporting.report import box_path_rms_m
from agent_proc.walking.stuck import STILL_CYCLES
from legpush.messages.planning import Plan, PlanQuery, TrunkPathQuery
from legpush.messages.stepping import Push
from legpush.scene.conventions import FRONT_LEGS
from legpush.scene.reference import Arcs, Left, Reference, Sine, Straight
from legpush.scene.scenario import Goal, MissionSettings, PoseDeg, PushSettings, Room, Scenario
from planner_proc.planning import make_plan
from tests.agent.fake_world import FakeWorld, make_scenario, scenario_at_station, straight_plan
from tests.agent.pushing.paths import EIGHT, along


def anywhere(x_m: float, y_m: float, yaw_deg: float) -> Scenario:
    scenario = make_scenario(room=Room(size_m=(12.0, 6.0)))
    return replace(scenario, goal=Goal(pose=PoseDeg(x_m=x_m, y_m=y_m, yaw_deg=yaw_deg)))


@pytest.mark.parametrize(
    ("x_m", "y_m", "yaw_deg", "expected"),
    [
        (5.0, 3.0, 0.0, {"front"}),
        (6.0, 4.0, 0.0, {"right"}),
        (7.0, 3.6, 0.0, {"rear", "right"}),
        (8.0, 4.0, 90.0, {"rear"}),
    ],
)
def test_a_mission_reaches_goals_anywhere(x_m: float, y_m: float, yaw_deg: float, expected: set[str]) -> None:
    scenario = anywhere(x_m, y_m, yaw_deg)
    world = FakeWorld(planner=make_plan)

    result = run_mission(world, scenario, 3, ScriptedPolicy())

    assert result.reason == "success"
    assert {push.face for push in world.motions(Push) if isinstance(push, Push)} == expected
    assert box_error(world.records[-1][1].world, scenario).within(scenario.goal)  # type: ignore[union-attr]


def test_faces_that_may_not_be_pushed_are_not() -> None:
    scenario = replace(anywhere(7.0, 3.6, 0.0), pushing=PushSettings(faces=("rear",)))
    world = FakeWorld(planner=make_plan)

    run_mission(world, scenario, 3, ScriptedPolicy())

    assert {push.face for push in world.motions(Push) if isinstance(push, Push)} <= {"rear"}
    assert all(len(query.sides) == 1 for query in world.box_queries())


def test_an_open_loop_plans_once_and_corrects_nothing() -> None:
    scenario = replace(anywhere(8.0, 4.0, 90.0), pushing=PushSettings(composition="open_loop", faces=("rear",)))
    exact, weak = FakeWorld(planner=make_plan), FakeWorld(planner=make_plan, push_scale=0.8)
    results = [run_mission(world, scenario, 3, ScriptedPolicy()) for world in (exact, weak)]

    pushes = [[replace(push, face="rear") for push in world.motions(Push)] for world in (exact, weak)]
    assert pushes[0] == pushes[1]
    assert results[0].success
    assert results[1].reason == "tolerance_missed"


@pytest.mark.parametrize("reference", [EIGHT, Sine(amplitude_m=0.3, wavelength_m=3.0, n_periods=1.0)])
def test_a_reference_is_followed_to_its_end_without_asking_for_a_path(reference: Reference) -> None:
    world = FakeWorld(push_scale=0.95)
    scenario = along(reference)

    result = run_mission(world, scenario, 3, ScriptedPolicy())

    assert result.success, result.detail
    rms_m = box_path_rms_m(read_record(iter(world.records)).steps)
    assert rms_m is not None
    assert rms_m < 0.015
    assert {push.face for push in world.motions(Push) if isinstance(push, Push)} == {"rear"}


def test_a_loop_is_pushed_though_the_box_begins_at_its_goal() -> None:
    loop = Arcs(radius_m=0.8, segments=(Left(angle_deg=350.0), Straight(length_m=0.1), Left(angle_deg=10.0)))
    world = FakeWorld()

    run_mission(world, along(loop), 3, ScriptedPolicy())

    assert len(world.motions(Push)) > 100


def test_a_reference_in_an_open_loop_is_pushed_the_same_whatever_the_box_does() -> None:
    exact, weak = FakeWorld(), FakeWorld(push_scale=0.8)
    results = [run_mission(world, along(EIGHT, "open_loop"), 3, ScriptedPolicy()) for world in (exact, weak)]

    assert exact.motions(Push) == weak.motions(Push)
    assert results[0].success
    assert results[1].reason == "tolerance_missed"
    assert not exact.box_queries()


def test_a_reference_that_turns_too_tightly_is_refused_before_the_robot_moves() -> None:
    world = FakeWorld()

    result = run_mission(world, along(Arcs(radius_m=0.3, segments=(Left(angle_deg=90.0),))), 3, ScriptedPolicy())

    assert result.reason == "no_path"
    assert "turns on a radius of 0.30 m, the box on no less than 0.5" in result.detail
    assert not world.motions(Push)


def test_a_box_that_leaves_its_reference_ends_the_mission() -> None:
    world = FakeWorld(sideways_m=0.02)

    result = run_mission(world, along(EIGHT), 3, ScriptedPolicy())

    assert result.reason == "left_reference"
    assert "the box left its reference after" in result.detail


def test_the_push_cycles_are_limited() -> None:
    scenario = replace(scenario_at_station(), mission=MissionSettings(max_push_cycles=4))
    world = FakeWorld()

    result = run_mission(world, scenario, 7, ScriptedPolicy())

    assert (result.success, result.reason, result.n_push_cycles) == (False, "max_push_cycles", 4)
    assert len(world.motions(Push)) == 4


def test_a_box_that_is_at_its_goal_needs_no_push() -> None:
    scenario = replace(scenario_at_station(), goal=Goal(pose=PoseDeg(x_m=6.0, y_m=3.0, yaw_deg=0.0)))
    world = FakeWorld()

    result = run_mission(world, scenario, 7, ScriptedPolicy())

    assert (result.success, result.n_push_cycles) == (True, 0)


def test_a_policy_that_stops_short_of_the_goal_misses_the_tolerance() -> None:
    behind = replace(scenario_at_station(), goal=Goal(pose=PoseDeg(x_m=5.0, y_m=3.0, yaw_deg=0.0)))

    result = run_mission(FakeWorld(), behind, 7, ScriptedPolicy())

    assert (result.success, result.reason) == (False, "tolerance_missed")


def test_a_box_that_does_not_move_ends_the_mission() -> None:
    world = FakeWorld(push_scale=0.0)

    result = run_mission(world, scenario_at_station(), 7, ScriptedPolicy())

    assert (result.reason, result.n_push_cycles) == ("stuck", STILL_CYCLES)


@pytest.mark.parametrize(
    ("push_scale", "reason"), [(STUCK_SHARE - 0.03, "stuck"), (STUCK_SHARE + 0.1, "max_push_cycles")]
)
@pytest.mark.parametrize("depth_m", [0.005, 0.05, 0.1])
def test_a_box_is_stuck_that_moves_less_than_a_share_of_what_is_commanded(
    depth_m: float, push_scale: float, reason: str
) -> None:
    """Short pushes move a box little, which does not make it stuck."""

    class Pushes:
        def __init__(self) -> None:
            self._n = 0

        def decide(self, _view: PushView) -> Push | None:
            self._n += 1
            return Push(w1=0.5, w2=0.5, leg=FRONT_LEGS[self._n % 2], depth_m=depth_m)

    scenario = replace(scenario_at_station(), mission=MissionSettings(max_push_cycles=9))
    result = run_mission(FakeWorld(push_scale=push_scale), scenario, 7, Pushes())

    assert result.reason == reason
    if reason == "stuck":
        assert result.n_push_cycles == STILL_CYCLES
        assert "5 push cycles moved the box" in result.detail


@pytest.mark.parametrize("policy", ["variable", "scripted"])
@pytest.mark.parametrize("lost_depth_m", [0.0035, 0.007, 0.0135])
def test_a_heavy_box_is_brought_through_stages_that_others_follow(lost_depth_m: float, policy: str) -> None:
    scenario = anywhere(7.0, 3.6, 0.0)
    world = FakeWorld(planner=make_plan, lost_depth_m=lost_depth_m)

    result = run_mission(world, scenario, 7, make_policy(policy))

    assert result.reason == "success", result.detail
    assert {push.face for push in world.motions(Push) if isinstance(push, Push)} == {"rear", "right"}
    assert result.n_push_cycles < 90


class Never:
    """A policy that holds that no push improves anything."""

    def decide(self, _view: PushView) -> Push | None:
        return None


def goal_ahead(distance_m: float, tolerance_m: float = 0.05) -> Scenario:
    """A robot at a box whose goal is straight ahead."""
    goal = Goal(pose=PoseDeg(x_m=6.0 + distance_m, y_m=3.0, yaw_deg=0.0), position_tolerance_m=tolerance_m)
    return replace(scenario_at_station(), goal=goal)


@pytest.mark.parametrize(
    ("distance_m", "push_scale", "reason", "n_paths"),
    [
        (AIM_M - 0.005, 1.0, "success", 0),
        (AIM_M + 0.005, 1.0, "success", 1),
        (AIM_M + 0.005, 0.0, "success", MAX_BETTER),
        (0.06, 1.0, "tolerance_missed", 1),
    ],
)
def test_a_box_within_the_tolerances_but_not_the_aim_is_pushed_on_a_few_times(
    distance_m: float, push_scale: float, reason: str, n_paths: int
) -> None:
    world = FakeWorld(push_scale=push_scale)

    result = run_mission(world, goal_ahead(distance_m), 7, Never())

    assert result.reason == reason
    assert len(world.box_queries()) == n_paths


def test_tolerances_that_are_tighter_than_the_aim_are_met() -> None:
    world = FakeWorld()

    result = run_mission(world, goal_ahead(0.015, tolerance_m=0.01), 7, Never())

    assert result.reason == "tolerance_missed"
    assert len(world.box_queries()) == 1


def test_a_mission_succeeds_if_the_box_is_within_its_tolerances_when_the_push_cycles_are_used_up() -> None:
    scenario = replace(goal_ahead(0.55, tolerance_m=0.5), mission=MissionSettings(max_push_cycles=4))

    result = run_mission(FakeWorld(), scenario, 7, ScriptedPolicy())

    assert (result.reason, result.n_push_cycles) == ("success", 4)


def test_a_reference_has_to_be_followed_to_its_end_even_with_the_box_at_its_goal() -> None:
    loop = Arcs(radius_m=0.8, segments=(Left(angle_deg=350.0), Straight(length_m=0.1), Left(angle_deg=10.0)))
    scenario = replace(along(loop), mission=MissionSettings(max_push_cycles=2))
    scenario = replace(scenario, goal=replace(scenario.goal, position_tolerance_m=0.5, angle_tolerance_deg=90.0))

    result = run_mission(FakeWorld(), scenario, 7, ScriptedPolicy())

    assert (result.reason, result.n_push_cycles) == ("max_push_cycles", 2)


def test_a_box_that_leaves_one_path_after_the_other_ends_the_mission() -> None:
    world = FakeWorld(sideways_m=0.06)

    result = run_mission(world, goal_ahead(2.0), 7, ScriptedPolicy())

    assert result.reason == "tolerance_missed"
    assert result.detail.endswith(f"after {MAX_PATHS} paths")
    assert len(world.box_queries()) == MAX_PATHS


def test_a_path_is_planned_again_if_the_robot_cannot_walk_to_the_next_face() -> None:
    def planner(query: PlanQuery) -> Plan:
        if isinstance(query, TrunkPathQuery) and not world.queries():
            return Plan(status="failed", reason="no way around the box")
        plan, n_paths = straight_plan(query), len(world.box_queries())
        return plan if n_paths else replace(plan, sides=(*(0,) * 25, *(1,) * 25))

    world = FakeWorld(planner=planner)

    result = run_mission(world, goal_ahead(1.0), 7, ScriptedPolicy())

    assert result.reason == "success"
    assert len(world.queries()) == 2
    assert len(world.box_queries()) == 2
    assert {push.face for push in world.motions(Push) if isinstance(push, Push)} == {"rear"}
