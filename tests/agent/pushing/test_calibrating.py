"""Calibration pushes: which ones there are, when there are none, and what is known after them."""

import pytest
from msgspec.structs import replace

from agent_proc.mission.mission import run_mission
from agent_proc.policies.scripted import ScriptedPolicy
from legpush.messages.planning import BoxPathQuery
from legpush.messages.stepping import Push
from legpush.scene.scenario import Goal, PoseDeg, PushSettings, Room
from planner_proc.planning import make_plan
from tests.agent.fake_world import FakeWorld, make_scenario


def calibrating(n_pushes: int, room: Room) -> list[BoxPathQuery | Push]:
    """What a mission asks and does, in order, with an unknown box that turns half as much again."""
    goal = Goal(pose=PoseDeg(x_m=8.0, y_m=4.0, yaw_deg=90.0))
    pushing = PushSettings(calibration_pushes=n_pushes, faces=("rear",))
    world = FakeWorld(planner=make_plan, turn_scale=1.5)
    result = run_mission(world, replace(make_scenario(room=room), goal=goal, pushing=pushing), 3, ScriptedPolicy())
    assert result.success, result.detail
    assert result.n_push_cycles == len(world.motions(Push))
    return [record[0] for record in world.records if isinstance(record[0], BoxPathQuery | Push)]


def test_a_robot_that_is_asked_to_calibrates_before_it_plans() -> None:
    plain, own = (calibrating(n, Room(size_m=(12.0, 6.0))) for n in (0, 6))
    first = next(index for index, step in enumerate(own) if isinstance(step, Push))

    legs = [step.leg for step in own[first : first + 6] if isinstance(step, Push)]
    assert legs == ["FL", "FR", "FR", "FL", "FL", "FR"]
    guessed, known = plain[0], own[first + 6]
    assert isinstance(guessed, BoxPathQuery)
    assert isinstance(known, BoxPathQuery)
    ratio = guessed.sides[0].min_turning_radius_m / known.sides[0].min_turning_radius_m
    assert ratio == pytest.approx(1.5, rel=0.06)


def test_without_the_space_for_it_nothing_is_calibrated() -> None:
    narrow = Room(size_m=(8.45, 6.0))

    plain, own = ([step for step in calibrating(n, narrow) if isinstance(step, Push)] for n in (0, 40))

    assert own == plain
