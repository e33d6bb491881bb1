"""The push cycles that a mission may use."""

import pytest
from msgspec.structs import replace

from agent_proc.frames.push_view import PushView
from agent_proc.mission.mission import run_mission
from agent_proc.push_model.estimate import PushEstimate
from agent_proc.pushing.budget import SPARE, SPARE_CYCLES, PushBudget
from agent_proc.pushing.stage import Stage
from legpush.bounds import MAX_PUSH_CYCLES
from legpush.messages.stepping import Push
from legpush.scene.conventions import FRONT_LEGS
from legpush.scene.names import Face
from legpush.scene.scenario import Goal, MissionSettings, PoseDeg
from tests.agent.fake_world import FakeWorld, scenario_at_station
from tests.agent.pushing.paths import AXLE_M, line

BOX = scenario_at_station().box
ESTIMATES: dict[Face, PushEstimate] = {"rear": PushEstimate(BOX)}


def stages(length_m: float) -> list[Stage]:
    return [Stage("rear", line("rear", length_m)[0], AXLE_M)]


@pytest.mark.parametrize("length_m", [0.1, 1.0, 16.0])
def test_an_automatic_number_follows_from_the_length_of_the_path_and_the_travel_of_a_push(length_m: float) -> None:
    budget = PushBudget(None, ESTIMATES)
    budget.take_path(stages(length_m), 7)

    n_pushes = length_m / PushEstimate(BOX).usual_travel_m
    assert 7 + SPARE * n_pushes + SPARE_CYCLES <= budget.n_cycles < 7 + SPARE * (n_pushes + 1) + SPARE_CYCLES


def test_no_number_is_beyond_what_a_scenario_may_say() -> None:
    budget = PushBudget(None, ESTIMATES)
    budget.take_path(stages(500.0), 7)
    assert budget.n_cycles == MAX_PUSH_CYCLES
    assert f"to {MAX_PUSH_CYCLES}" in budget.used_up(stages(500.0), 0.0, "box error").remedy


def test_the_number_of_the_scenario_holds_whatever_the_path() -> None:
    budget = PushBudget(12, ESTIMATES)
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
