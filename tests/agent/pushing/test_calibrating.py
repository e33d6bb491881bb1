"""Calibration pushes: which ones there are, when there are none, and what is known after them."""

import pytest
from msgspec.structs import replace

from agent_proc.mission.mission import run_mission
from agent_proc.policies.scripted import ScriptedPolicy
from legpush.geometry import distance_m
from legpush.messages.common import USUAL_DEPTH_M
from legpush.messages.planning import BoxPathQuery, Plan, PlanQuery
from legpush.messages.stepping import Push
from legpush.scene.scenario import Goal, MissionSettings, PoseDeg, PushSettings, Rectangle, Room
from planner_proc.planning import make_plan
from tests.agent.fake_world import FakeWorld, make_scenario, scenario_at_station, straight_plan
from tests.agent.parts import Parts, parts_in


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


def at_the_box(n_pushes: int, world: FakeWorld, **changes: object) -> Parts:
    """A robot at the rear face of a box that is calibrated with `n_pushes` pushes."""
    asked = replace(scenario_at_station(), pushing=PushSettings(calibration_pushes=n_pushes))
    return parts_in(world, replace(asked, **changes))


def test_pushes_are_those_of_the_push_model_with_both_legs_in_turn() -> None:
    parts = at_the_box(6, FakeWorld())

    parts.calibration.run("rear")

    w1, w2 = parts.pushes.estimates["rear"].curve
    assert parts.world.motions(Push) == [
        Push(w1=w1, w2=w2, leg=leg, depth_m=USUAL_DEPTH_M, face="rear") for leg in ("FL", "FR", "FR", "FL", "FL", "FR")
    ]
    told = [(share, detail) for phase, share, detail in parts.world.told if phase == "calibrating"]
    assert told[0] == (0.0, "push 1 of 6, rear face")
    assert told[3] == (0.5, "push 4 of 6, rear face")


def test_the_estimate_learns_from_each_push() -> None:
    parts = at_the_box(6, FakeWorld(push_scale=0.6))

    parts.calibration.run("rear")

    assert parts.pushes.estimates["rear"].travel_scale < 0.8
    assert parts.pushes.estimates["left"].travel_scale == 1.0


@pytest.mark.parametrize(
    ("status", "too_long_m", "n_pushes"), [("exact", 0.004, 6), ("exact", 0.006, 0), ("failed", 0.0, 0)]
)
def test_nothing_is_pushed_unless_the_way_ahead_is_straight(status: str, too_long_m: float, n_pushes: int) -> None:
    def planner(query: PlanQuery) -> Plan:
        length_m = distance_m(query.start, query.goal) + too_long_m
        return replace(straight_plan(query), status=status, length_m=length_m)

    parts = at_the_box(6, FakeWorld(planner=planner))

    parts.calibration.run("rear")

    assert len(parts.world.motions(Push)) == n_pushes
    assert len(parts.world.box_queries()) == 1


def test_a_calibration_ends_with_the_push_cycles_of_the_mission() -> None:
    parts = at_the_box(6, FakeWorld(), mission=MissionSettings(max_push_cycles=4))

    parts.calibration.run("rear")

    assert len(parts.world.motions(Push)) == 4


def test_a_calibration_ends_when_something_appears_anywhere() -> None:
    aside = Rectangle(x_min_m=1.0, x_max_m=1.2, y_min_m=5.0, y_max_m=5.6, appears_at_s=5.0)
    parts = at_the_box(6, FakeWorld(), room=Room(size_m=(12.0, 6.0), obstacles=(aside,)))

    parts.calibration.run("rear")

    assert len(parts.world.motions(Push)) == 2
