"""A mission that is driven from outside: it is the same mission, and leaves no thread behind."""

import gc
import subprocess
import sys
import threading
from textwrap import dedent
from typing import Any

import pytest

from agent_proc.mission.driven import DrivenMission
from agent_proc.mission.mission import run_mission
from agent_proc.policies.scripted import ScriptedPolicy
from legpush.errors import BrokenEpisodeError, ConfigError, ScenarioError
from legpush.messages.stepping import Motion, Outcome, Push, Reset
from tests.agent.fake_world import FakeWorld, make_scenario, scenario_at_station

SEED = 7


def thinking() -> list[str]:
    """The threads of missions."""
    return [thread.name for thread in threading.enumerate() if thread.name == "mission"]


def run(mission: DrivenMission, n_pushes: int | None = None) -> None:
    """Answer by the scripted policy, to the end of the mission or a number of times."""
    policy, n = ScriptedPolicy(), 0
    while mission.view is not None and n != n_pushes:
        mission.answer(policy.decide(mission.view))
        n += 1


def waiting() -> DrivenMission:
    """A mission that asks for its third push."""
    mission = DrivenMission(FakeWorld(), scenario_at_station(), SEED)
    run(mission, 2)
    assert mission.view is not None
    assert thinking() == ["mission"]
    return mission


class InterruptedWorld(FakeWorld):
    """Raises an error instead of carrying out a motion, by its kind and the number of those before it."""

    def __init__(self, error: BaseException, at: type[Push | Reset] = Push, n_before: int = 2) -> None:
        super().__init__()
        self.error, self.at, self.n_before = error, at, n_before

    def step(self, motion: Motion, *, with_trace: bool = False) -> Outcome:
        if isinstance(motion, self.at) and len(self.motions(self.at)) == self.n_before:
            raise self.error
        return super().step(motion, with_trace=with_trace)


@pytest.mark.parametrize("fields", [{}, {"box_offset": (0.04, -0.05, 0.07)}, {"lost_depth_m": 0.2}])
def test_it_is_the_mission_that_runs_by_itself(fields: dict[str, Any]) -> None:
    here, there = FakeWorld(**fields), FakeWorld(**fields)
    mission = DrivenMission(here, make_scenario(), SEED)
    run(mission)

    assert mission.result == run_mission(there, make_scenario(), SEED, ScriptedPolicy())
    assert here.records == there.records
    assert here.rewards == there.rewards
    assert thinking() == []
    with pytest.raises(ConfigError, match="got one that is over"):
        mission.answer(None)


def test_it_waits_for_each_push() -> None:
    world = FakeWorld()
    mission = DrivenMission(world, make_scenario(), SEED)

    assert world.motions(Push) == []
    assert len(world.motions(Reset)) == 1
    push = ScriptedPolicy().decide(mission.view)  # type: ignore[arg-type]
    mission.answer(push)
    assert world.motions(Push) == [push]
    mission.abandon()


def test_to_stop_goes_on_with_the_mission() -> None:
    mission = waiting()
    n_stops = 0
    while mission.view is not None:
        mission.answer(None)
        n_stops += 1

    assert n_stops > 1
    assert mission.result is not None
    assert mission.result.reason == "tolerance_missed"


def test_an_abandoned_mission_ends_its_thread() -> None:
    mission = waiting()
    mission.abandon()
    mission.abandon()

    assert thinking() == []
    assert mission.result is None


def test_a_lost_mission_ends_its_thread() -> None:
    mission = waiting()
    del mission
    gc.collect()

    assert thinking() == []


def test_an_error_of_the_world_that_ends_a_mission_is_in_its_result() -> None:
    mission = DrivenMission(InterruptedWorld(BrokenEpisodeError("numbers")), scenario_at_station(), SEED)
    run(mission)

    assert mission.result is not None
    assert (mission.result.reason, str(mission.result.error)) == ("episode_broken", "numbers")
    assert thinking() == []


@pytest.mark.parametrize("error", [ScenarioError("another error"), ValueError("a fault"), KeyboardInterrupt()])
def test_another_error_and_an_interruption_are_raised_where_the_mission_is_driven(error: BaseException) -> None:
    mission = DrivenMission(InterruptedWorld(error), scenario_at_station(), SEED)
    with pytest.raises(type(error)):
        run(mission)

    assert thinking() == []
    assert mission.view is None


def test_an_error_before_the_first_push_is_raised_as_well() -> None:
    with pytest.raises(ScenarioError, match="no such room"):
        DrivenMission(InterruptedWorld(ScenarioError("no such room"), at=Reset, n_before=0), make_scenario(), SEED)
    assert thinking() == []


def test_a_process_ends_although_nobody_ended_its_mission() -> None:
    program = """
        from agent_proc.mission.driven import DrivenMission
        from tests.agent.fake_world import FakeWorld, scenario_at_station
        mission = DrivenMission(FakeWorld(), scenario_at_station(), 1)
        print(mission.view is not None)
    """
    done = subprocess.run(
        [sys.executable, "-c", dedent(program)], capture_output=True, text=True, timeout=60.0, check=False
    )
    assert (done.returncode, done.stdout.split(), done.stderr) == (0, ["True"], "")
