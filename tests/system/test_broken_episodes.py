"""Simulators and planners that fail at a valid message: they go on, and the agent ends once, with what happened."""

import subprocess
import sys
from contextlib import ExitStack
from math import nan
from pathlib import Path

import pytest
from msgspec.structs import replace

from legpush.bus import endpoints
from legpush.errors import BrokenEpisodeError
from legpush.history.entries import Acted, Observed
from legpush.history.journal import read_entries
from legpush.messages.common import Role
from legpush.messages.planning import Plan, PlanQuery
from legpush.messages.stepping import Motion, Outcome
from tests.legpush.examples import QUERY, TRACE
from tests.legpush.fakes import RUN, FakeStepper, agent, crc_after, fake_plan, mission, planner, sim

MISSION = mission(4)
FAIL_AT = 5


class FailsOnce(FakeStepper):
    """Raises an exception in one motion."""

    def perform(self, motion: Motion, *, with_trace: bool) -> Outcome:
        if len(self.performed) == FAIL_AT:
            self.performed.clear()
            raise ZeroDivisionError("float division by zero")
        return super().perform(motion, with_trace=with_trace)


def test_a_simulator_that_fails_ends_the_episode_and_begins_the_next(tmp_path: Path) -> None:
    stepper = FailsOnce()
    with sim(tmp_path, stepper) as serving, agent(tmp_path) as asking:
        for _ in range(2):
            with pytest.raises(BrokenEpisodeError, match=r"Step 5: .*failed in a push: ZeroDivisionError"):
                asking.do(MISSION[len(asking.past) :])
        assert serving.tally["invalid"] >= 2
        asking.past = []
        asking.sim.begin()
        assert asking.do(MISSION[:FAIL_AT]) == crc_after(MISSION[:FAIL_AT])
    assert stepper.performed == MISSION[:FAIL_AT]


class SpoilsTraces(FakeStepper):
    """Measures something that is no number."""

    def perform(self, motion: Motion, *, with_trace: bool) -> Outcome:
        outcome = super().perform(motion, with_trace=with_trace)
        trace = replace(TRACE, support_margin_m=(nan,))
        return replace(outcome, trace=trace) if with_trace else outcome


def test_a_trace_that_no_message_can_hold_breaks_the_episode(tmp_path: Path) -> None:
    stepper = SpoilsTraces()
    with sim(tmp_path, stepper) as serving, agent(tmp_path) as asking:
        asking.do(MISSION[:2])
        for words in ("Expected a finite number, got nan", "broken since step 2: Expected a finite number, got nan"):
            with pytest.raises(BrokenEpisodeError, match=f"Step 2: {words}"):
                asking.sim.step(MISSION[2], asking.past, with_trace=True)
        assert serving.tally["invalid"] >= 1
        assert len(stepper.performed) == 3
        asking.past = []
        asking.sim.begin()
        assert asking.do(MISSION) == crc_after(MISSION)


def test_a_planner_that_fails_answers_and_goes_on(tmp_path: Path) -> None:
    def fail_at_7(query: PlanQuery) -> Plan:
        if query.seed == 7:
            raise OverflowError("math range error")
        return fake_plan(query)

    with planner(tmp_path, fail_at_7), agent(tmp_path) as asking:
        failed = asking.planner.plan(replace(QUERY, seed=7))
        assert (failed.status, failed.reason) == ("failed", "The planner failed: OverflowError: math range error")
        assert asking.planner.plan(QUERY) == fake_plan(QUERY)


def test_an_agent_whose_simulator_fails_ends_as_with_bad_input_and_a_new_simulator_can_go_on(tmp_path: Path) -> None:
    journal = tmp_path / "episode-0000.journal"

    def start(role: Role, *flags: str) -> subprocess.Popen[str]:
        at = endpoints.in_directory(tmp_path, role)
        script = (sys.executable, str(Path(__file__).with_name("fake_process.py")), role)
        links = ("--run", RUN, "--listen", *at.listen, "--connect", *at.connect)
        return subprocess.Popen([*script, *links, *flags], stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    with planner(tmp_path), ExitStack() as stack:
        failing = stack.enter_context(start("sim", "--fail-at", str(FAIL_AT)))
        stack.callback(failing.terminate)
        for words in ("", "broken since step 5: "):
            with start("agent", "--journal", str(journal)) as asking:
                _, said = asking.communicate(timeout=30.0)
            assert asking.returncode == 2
            error = f"error: Step 5: {words}The simulator failed in a push: OverflowError: math range error; "
            assert said.splitlines()[-1].startswith(error)
            assert "Traceback" not in said
        assert [type(entry) for entry in read_entries(journal)][-2:] == [Observed, Acted]
        failing.terminate()
        _, log = failing.communicate(timeout=10.0)
        assert failing.returncode == 0
        assert log.count("is broken since step 5") == 1
        assert "Traceback" in log
        whole = stack.enter_context(start("sim"))
        stack.callback(whole.terminate)
        with start("agent", "--journal", str(journal)) as asking:
            told, said = asking.communicate(timeout=30.0)
        assert asking.returncode == 0, said
    assert told == f"{QUERY.seed} {crc_after(mission())}\n"
