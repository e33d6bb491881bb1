"""Docking in missions whose world moves the box as the push model says."""

import pytest
from msgspec.structs import replace

from agent_proc.frames.push_view import PushView
from agent_proc.mission.mission import run_mission
from agent_proc.pushing.pushing import AIM_M
from legpush.messages.planning import Plan, PlanQuery, TrunkPathQuery
from legpush.messages.stepping import Push
from legpush.scene.conventions import FRONT_LEGS
from legpush.scene.scenario import Goal, MissionSettings, PoseDeg, PushSettings, Scenario
from planner_proc.planning import make_plan
from tests.agent.fake_world import FakeWorld, scenario_at_station


class StopsBeyond:
    """A policy that pushes with both legs in turn until the box is this far beyond its goal."""

    def __init__(self, beyond_m: float) -> None:
        self._beyond_m, self._n = beyond_m, 0

    def decide(self, view: PushView) -> Push | None:
        if view.box_g.x_m >= self._beyond_m:
            return None
        self._n += 1
        return Push(w1=0.5, w2=0.5, leg=FRONT_LEGS[self._n % 2], depth_m=0.05)


def scenario(**changes: object) -> Scenario:
    """A robot at a box whose goal is 0.5 m straight ahead."""
    goal = Goal(pose=PoseDeg(x_m=6.5, y_m=3.0, yaw_deg=0.0))
    return replace(scenario_at_station(), goal=goal, **changes)


def pushes(world: FakeWorld) -> list[Push]:
    return [push for push in world.motions(Push) if isinstance(push, Push)]


@pytest.mark.parametrize("beyond_m", [0.04, 0.1, 0.2])
@pytest.mark.parametrize("push_scale", [0.8, 1.0, 1.2])
def test_a_box_beyond_its_goal_is_pushed_back_without_another_path(beyond_m: float, push_scale: float) -> None:
    world = FakeWorld(planner=make_plan, push_scale=push_scale)
    result = run_mission(world, scenario(), 3, StopsBeyond(beyond_m))

    assert result.success, result.detail
    assert len(world.box_queries()) == 1
    assert pushes(world)[-1].face == "front"
    assert result.n_push_cycles <= 0.5 / (0.03 * push_scale) + beyond_m / (0.03 * push_scale) + 6


def test_a_box_too_far_from_its_goal_gets_another_path() -> None:
    world = FakeWorld(planner=make_plan)
    run_mission(world, scenario(), 3, StopsBeyond(PushSettings().docking_m + 0.05))

    assert len(world.box_queries()) > 1


@pytest.mark.parametrize("docking_m", [0.0, 0.05])
def test_docking_can_be_confined_or_switched_off(docking_m: float) -> None:
    world = FakeWorld(planner=make_plan)
    run_mission(world, scenario(pushing=PushSettings(docking_m=docking_m)), 3, StopsBeyond(0.1))

    assert len(world.box_queries()) > 1


def test_a_goal_beside_the_box_is_docked_at_once() -> None:
    beside = Goal(pose=PoseDeg(x_m=6.1, y_m=3.1, yaw_deg=10.0))
    world = FakeWorld(planner=make_plan)
    result = run_mission(world, replace(scenario(), goal=beside), 3, StopsBeyond(0.0))

    assert result.success, result.detail
    assert not world.box_queries()
    assert result.n_push_cycles < 20


def test_a_box_that_may_be_pushed_at_one_face_only_gets_another_path() -> None:
    world = FakeWorld(planner=make_plan)
    run_mission(world, scenario(pushing=PushSettings(faces=("rear",))), 3, StopsBeyond(0.1))

    assert len(world.box_queries()) > 1
    assert {push.face for push in pushes(world)} == {"rear"}


def test_a_face_that_the_robot_cannot_come_to_is_left_out() -> None:
    def planner(query: PlanQuery) -> Plan:
        if isinstance(query, TrunkPathQuery) and query.goal.x_m > 6.7:
            return Plan(status="failed", reason="closed")
        return make_plan(query)

    world = FakeWorld(planner=planner)
    run_mission(world, scenario(), 3, StopsBeyond(0.1))

    assert any(query.goal.x_m > 6.7 for query in world.queries())
    assert "front" not in {push.face for push in pushes(world)}


def test_docking_counts_as_pushing() -> None:
    few = scenario(mission=MissionSettings(max_push_cycles=20))
    world = FakeWorld(planner=make_plan)
    result = run_mission(world, few, 3, StopsBeyond(0.1))

    assert (result.success, result.reason, result.n_push_cycles) == (False, "max_push_cycles", 20)
    assert "pushes are left" in result.detail
    assert "set `mission.max_push_cycles` to " in result.remedy
    assert {push.face for push in pushes(world)} == {"rear", "front"}


def test_the_box_comes_within_the_aim() -> None:
    loose = Goal(pose=PoseDeg(x_m=6.5, y_m=3.0, yaw_deg=0.0), position_tolerance_m=0.1, angle_tolerance_deg=10.0)
    world = FakeWorld(planner=make_plan)
    result = run_mission(world, replace(scenario(), goal=loose), 3, StopsBeyond(0.06))

    assert result.success
    assert len(world.box_queries()) == 1
    assert world.records[-1][1].world.box.position_m[0] == pytest.approx(6.5, abs=AIM_M)  # type: ignore[union-attr]
