"""The push cycles that a mission may use."""

import pytest
from msgspec.structs import replace

from agent_proc.endings import MissionResult
from agent_proc.frames.push_view import PushView
from agent_proc.mission.mission import run_mission
from agent_proc.policies.scripted import ScriptedPolicy
from agent_proc.push_model.estimate import PushEstimate
from agent_proc.pushing.budget import SPARE, SPARE_CYCLES, PushBudget
from agent_proc.pushing.least_pushes import most_travel_m
from agent_proc.pushing.stage import Stage
from legpush.bounds import MAX_DEPTH_M, MAX_PUSH_CYCLES
from legpush.geometry import Pose2
from legpush.messages.stepping import Push, Walk
from legpush.scene.conventions import FRONT_LEGS
from legpush.scene.names import Face
from legpush.scene.scenario import Goal, MissionSettings, PoseDeg, Room, Scenario
from tests.agent.fake_world import FakeWorld, KinematicSimulator, make_scenario, scenario_at_station
from tests.agent.pushing.paths import AXLE_M, EIGHT, along, line

BOX = scenario_at_station().box
ESTIMATES: dict[Face, PushEstimate] = {"rear": PushEstimate(BOX)}


def budget_of(most: int | None) -> PushBudget:
    return PushBudget(replace(scenario_at_station(), mission=MissionSettings(max_push_cycles=most)), ESTIMATES)


def stages(length_m: float) -> list[Stage]:
    return [Stage("rear", line("rear", length_m)[0], AXLE_M)]


@pytest.mark.parametrize("length_m", [0.1, 1.0, 16.0])
def test_an_automatic_number_follows_from_the_length_of_the_path_and_the_travel_of_a_push(length_m: float) -> None:
    budget = budget_of(None)
    budget.take_path(stages(length_m), 7)

    n_pushes = length_m / PushEstimate(BOX).usual_travel_m
    assert 7 + SPARE * n_pushes + SPARE_CYCLES <= budget.n_cycles < 7 + SPARE * (n_pushes + 1) + SPARE_CYCLES


def test_no_number_is_beyond_what_a_scenario_may_say() -> None:
    budget = budget_of(None)
    budget.take_path(stages(500.0), 7)
    assert budget.n_cycles == MAX_PUSH_CYCLES
    assert f"to {MAX_PUSH_CYCLES}" in budget.used_up_on_path(stages(500.0), 0.0, "box error").remedy


def test_the_number_of_the_scenario_holds_whatever_the_path() -> None:
    budget = budget_of(12)
    budget.take_path(stages(16.0), 0)
    assert budget.n_cycles == 12


class Weak:
    """Straight on, with short pushes."""

    def __init__(self) -> None:
        self._n = 0

    def decide(self, view: PushView) -> Push | None:
        self._n += 1
        depth_m = 0.02 if view.box_g.x_m < -0.02 else 0.0
        return Push(w1=0.5, w2=0.5, leg=FRONT_LEGS[self._n % 2], depth_m=depth_m) if depth_m else None


def test_a_mission_says_which_number_would_do_and_succeeds_with_it() -> None:
    scenario = replace(
        scenario_at_station(),
        goal=Goal(pose=PoseDeg(x_m=9.0, y_m=3.0, yaw_deg=0.0), position_tolerance_m=0.3),
        mission=MissionSettings(max_push_cycles=20),
    )
    short = run_mission(FakeWorld(), scenario, 7, Weak())

    assert (short.reason, short.n_push_cycles) == ("max_push_cycles", 20)
    assert "after 20 push cycles, " in short.detail
    number = short.remedy.removeprefix("set `mission.max_push_cycles` to ").partition(",")[0]
    enough = run_mission(
        FakeWorld(), replace(scenario, mission=MissionSettings(max_push_cycles=int(number))), 7, Weak()
    )
    assert enough.success
    assert run_mission(FakeWorld(), replace(scenario, mission=MissionSettings()), 7, Weak()).success


class Deep:
    """Straight on, with pushes as deep as they may be."""

    def decide(self, view: PushView) -> Push | None:
        return Push(w1=0.5, w2=0.5, leg="FL", depth_m=MAX_DEPTH_M) if view.box_g.x_m < -0.01 else None


class BestSimulator(KinematicSimulator):
    """Each push moves the box straight ahead, as far as a push can."""

    def _pushed(self, push: Push) -> Pose2:
        return self._box @ Pose2(x_m=most_travel_m(self._scenario), y_m=0.0, yaw_rad=0.0)


def at_distance(distance_m: float, friction: float, n_cycles: int | None) -> Scenario:
    """A robot that has to walk to a box, which may then be pushed this often."""
    scenario = make_scenario(box=replace(BOX, friction=friction), room=Room(size_m=(30.0, 6.0)))
    goal = Goal(pose=PoseDeg(x_m=6.0 + distance_m, y_m=3.0, yaw_deg=0.0))
    return replace(scenario, goal=goal, mission=MissionSettings(max_push_cycles=n_cycles))


@pytest.mark.parametrize("friction", [0.05, 0.5])
@pytest.mark.parametrize("n_cycles", [1, 2, 9])
def test_a_number_is_refused_before_the_robot_moves_only_if_no_push_could_do(n_cycles: int, friction: float) -> None:
    distance_m = n_cycles * most_travel_m(at_distance(1.0, friction, None))

    enough = run_mission(FakeWorld(simulator=BestSimulator()), at_distance(distance_m, friction, n_cycles), 7, Deep())
    assert (enough.reason, enough.n_push_cycles) == ("success", n_cycles)

    world = FakeWorld(simulator=BestSimulator())
    refused = run_mission(world, at_distance(distance_m + 0.1, friction, n_cycles), 7, Deep())
    assert (refused.reason, refused.n_push_cycles, refused.handover_distance_m) == ("max_push_cycles", 0, None)
    assert refused.detail.startswith(f"`mission.max_push_cycles` is {n_cycles}, but the box has to move ")
    assert not world.motions(Walk)
    assert not world.motions(Push)


def test_the_remedy_of_a_refused_number_does() -> None:
    refused = run_mission(FakeWorld(), at_distance(2.0, 0.5, 2), 7, ScriptedPolicy())

    assert refused.n_push_cycles == 0
    number = refused.remedy.removeprefix("set `mission.max_push_cycles` to ").partition(",")[0]
    assert run_mission(FakeWorld(), at_distance(2.0, 0.5, int(number)), 7, ScriptedPolicy()).success


def test_a_reference_calls_for_its_length_and_a_number_that_does_is_not_refused() -> None:
    def following(most: int | None) -> MissionResult:
        scenario = replace(along(EIGHT), start=make_scenario().start, mission=MissionSettings(max_push_cycles=most))
        return run_mission(FakeWorld(), scenario, 7, ScriptedPolicy())

    free = following(None)
    assert free.success
    assert following(free.n_push_cycles).success
    assert (following(9).reason, following(9).n_push_cycles) == ("max_push_cycles", 0)


def test_a_robot_that_stands_at_the_box_pushes_it_as_often_as_it_may() -> None:
    scenario = replace(at_distance(5.0, 0.5, 2), start=scenario_at_station().start)
    result = run_mission(FakeWorld(), scenario, 7, ScriptedPolicy())
    assert (result.reason, result.n_push_cycles) == ("max_push_cycles", 2)
