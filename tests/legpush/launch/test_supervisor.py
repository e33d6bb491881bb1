"""The launcher's supervisor, with small scripts in the place of planner, simulator and agent."""

import os
import signal
import sys
from itertools import count
from pathlib import Path

import pytest

from legpush.launch.supervisor import Limits, Verdict
from legpush.messages.common import PROTOCOL_VERSION, Header
from legpush.messages.telemetry import Status
from legpush.processes.child import Command
from legpush.processes.crew import Crew
from tests.legpush.launch.stage import Stage


@pytest.fixture
def stage(tmp_path: Path) -> Stage:
    return Stage(tmp_path)


def status(role: str, phase: str, fraction: float | None = None, detail: str = "", waiting_for: str = "") -> Status:
    header = Header(protocol=PROTOCOL_VERSION, run="r", role=role, name=role, incarnation="i", sequence=0)  # type: ignore[arg-type]
    return Status(header=header, phase=phase, fraction=fraction, detail=detail, waiting_for=waiting_for)


@pytest.mark.parametrize("code", [0, 1])
def test_the_mission_ends_as_the_agent_says_and_nothing_is_left(stage: Stage, code: int) -> None:
    verdict = stage.run({"planner": "ready", "sim": "ready", "agent": f"ready await=planner await=sim exit={code}"})
    assert verdict == Verdict(code)
    assert stage.orphans() == []
    assert stage.display.notices == []


@pytest.mark.parametrize("role", ["planner", "sim", "agent"])
def test_a_process_that_dies_is_started_again_and_that_is_said(stage: Stage, role: str) -> None:
    orders = {"planner": "ready", "sim": "ready", "agent": "ready"}
    orders[role] = "ready kill=1 mark=again"
    orders["agent"] += " await=again exit=0"
    assert stage.run(orders) == Verdict(0)
    (notice,) = stage.display.notices
    log = stage.folder / f"{role}.log"
    assert notice == f"the {role} was killed by SIGKILL; starting it again (1 of 3); its log is {log}"
    assert stage.orphans() == []


def test_three_restarts_are_survived_the_fourth_death_is_not(stage: Stage) -> None:
    assert stage.run({"sim": "ready die=3:1 mark=again", "agent": "ready await=again exit=0"}) == Verdict(0)
    assert len(stage.pids("sim")) == 4


def test_the_launcher_gives_up_when_a_process_dies_four_times(stage: Stage) -> None:
    verdict = stage.run({"planner": "ready", "sim": "ready die=9:7", "agent": "ready"})
    assert verdict.exit_code == 3
    assert verdict.reason.startswith("the sim exited with 7 after 3 restarts; the end of ")
    assert verdict.reason.endswith("    life 3 of the sim")
    assert len(stage.pids("sim")) == 4
    assert [notice.split(";")[1] for notice in stage.display.notices] == [
        f" starting it again ({n} of 3)" for n in (1, 2, 3)
    ]
    assert stage.orphans() == []


def test_each_process_has_its_own_restarts(stage: Stage) -> None:
    verdict = stage.run(
        {
            "planner": "ready die=3:1 mark=p",
            "sim": "ready await=p die=3:1 mark=s",
            "agent": "ready await=p await=s die=2:3 exit=1",
        }
    )
    assert verdict == Verdict(1)
    assert len(stage.display.notices) == 8


def test_a_peer_that_ends_before_the_mission_does_is_started_again_even_if_it_is_content(stage: Stage) -> None:
    assert stage.run({"sim": "ready die=1:0 mark=again", "agent": "ready await=again exit=0"}) == Verdict(0)
    log = stage.folder / "sim.log"
    assert stage.display.notices == [
        f"the sim exited with 0; starting it again (1 of 3); the end of {log}:\n    life 0 of the sim"
    ]


@pytest.mark.parametrize("role", ["planner", "agent"])
def test_bad_input_is_not_tried_again_and_its_error_is_shown(stage: Stage, role: str) -> None:
    orders = {"planner": "ready", "agent": "ready"} | {role: "exit=2"}
    verdict = stage.run(orders)
    log = stage.folder / f"{role}.log"
    assert verdict == Verdict(2, f"the {role} exited with 2: life 0 of the {role}; its log is {log}")
    assert len(stage.pids(role)) == 1
    assert stage.orphans() == []


def test_a_full_disk_is_not_tried_again_and_has_an_exit_code_of_its_own(stage: Stage) -> None:
    verdict = stage.run({"planner": "ready", "sim": "ready", "agent": "ready die=9:5"})
    log = stage.folder / "agent.log"
    # It could not write an error into its log any more.
    assert verdict == Verdict(
        5, f"the agent exited with 5: No space left on device, also not for its log; its log is {log}"
    )


@pytest.mark.parametrize("code", [0, 1])
def test_an_agent_that_leaves_no_result_has_failed_and_its_last_words_are_told(stage: Stage, code: int) -> None:
    stage.has_result = False
    verdict = stage.run({"planner": "ready", "agent": f"ready exit={code}"})
    log = stage.folder / "agent.log"
    assert verdict == Verdict(
        3, f"the agent exited with {code} without a result of the mission; the end of {log}:\n    life 0 of the agent"
    )


def test_a_process_that_does_not_become_ready_is_named_with_the_end_of_its_log(stage: Stage) -> None:
    verdict = stage.run({"planner": "ready", "sim": "", "agent": "ready"}, Limits(ready_s=0.3))
    assert verdict.exit_code == 3
    (pid,) = stage.pids("sim")
    assert verdict.reason.startswith(
        f"the sim did not become ready in 0.3 s, although it runs (process {pid}); the end of {stage.folder}/sim.log:"
    )
    assert verdict.reason.endswith("\n    life 0 of the sim")
    assert stage.orphans() == []


def test_a_process_whose_sign_of_life_stays_away_is_named(stage: Stage) -> None:
    def on_progress() -> None:
        if stage.display.shown[-1] == ("starting", None, "", ""):  # nobody is missing any more
            (stage.folder / "sim").unlink(missing_ok=True)

    stage.display.on_progress = on_progress
    verdict = stage.run({"sim": "ready", "agent": "ready"}, Limits(ready_s=0.3))
    assert verdict.exit_code == 3
    assert verdict.reason.startswith("the sim has shown no sign of life for 0.3 s, although it runs")


def test_while_processes_start_the_missing_ones_are_shown(stage: Stage) -> None:
    assert stage.run({"sim": "await=agent ready", "agent": "ready await=sim exit=0"}) == Verdict(0)
    assert stage.display.shown[0] == ("starting", None, "", "sim, agent")


def test_what_the_agent_says_is_shown_and_what_others_say_is_not(stage: Stage) -> None:
    stage.said = [
        status("agent", "walking", 0.25, "2.0 of 8.0 m"),
        status("sim", "stepping"),
    ]
    assert stage.run({"sim": "ready", "agent": "ready await=sim exit=0"}) == Verdict(0)
    assert ("walking", 0.25, "2.0 of 8.0 m", "") in stage.display.shown
    assert {phase for phase, *_ in stage.display.shown} <= {"starting", "walking", "stopping"}


def test_a_mission_that_takes_too_long_ends_with_what_it_was_doing(stage: Stage) -> None:
    stage.said = [status("agent", "planning", waiting_for="planner (frozen)")]
    verdict = stage.run({"planner": "ready", "agent": "ready"}, Limits(mission_s=0.2))
    assert verdict == Verdict(3, "the mission did not end in 0.2 s; it was planning, waiting for planner (frozen)")
    assert stage.orphans() == []


def test_a_frozen_process_is_named_and_the_mission_goes_on_when_it_does(stage: Stage) -> None:
    def on_notice(notice: str) -> None:
        if "frozen" in notice:
            os.kill(stage.pids("sim")[0], signal.SIGCONT)
        else:
            (stage.folder / "seen").touch()

    stage.display.on_notice = on_notice
    assert stage.run({"sim": "ready freeze", "agent": "ready await=seen exit=0"}) == Verdict(0)
    (pid,) = stage.pids("sim")
    assert stage.display.notices == [f"the sim is frozen; `kill -CONT {pid}` lets it go on", "the sim goes on"]


def test_time_in_which_a_process_is_frozen_does_not_count(stage: Stage) -> None:
    times = count(step=0.02)
    frozen_at: list[float] = []

    def clock() -> float:
        """Goes on whenever somebody looks at it, and lets the simulator go on after 4 s."""
        now = next(times)
        if stage.display.notices and not frozen_at:
            frozen_at.append(now)
        if frozen_at and now > frozen_at[0] + 4.0:
            os.kill(stage.pids("sim")[0], signal.SIGCONT)
        return now

    stage.clock = clock
    limits = Limits(mission_s=3.0, ready_s=3.0)
    assert stage.run({"sim": "freeze ready", "agent": "ready await=sim.thawed exit=0"}, limits) == Verdict(0)
    assert next(times) > frozen_at[0] + 4.0


def interrupt_when(stage: Stage, name: str, number: signal.Signals) -> None:
    """Send this very process a signal as soon as a file is there."""
    done: list[bool] = []

    def on_progress() -> None:
        if not done and (stage.folder / name).exists():
            done.append(True)
            os.kill(os.getpid(), number)

    stage.display.on_progress = on_progress
    stage.said = [status("agent", "walking")]


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_an_interrupt_ends_everything_with_130(stage: Stage, number: signal.Signals) -> None:
    interrupt_when(stage, "up", number)
    verdict = stage.run({"planner": "ready child mark=up", "agent": "ready"})
    assert verdict == Verdict(130, f"interrupted by {number.name}")
    assert len(stage.pids("planner")) == 2
    assert stage.orphans() == []


def test_processes_may_end_by_themselves_before_they_are_killed(stage: Stage) -> None:
    interrupt_when(stage, "sim", signal.SIGTERM)
    stage.run({"sim": "tidy ready", "agent": ""})
    assert (stage.folder / "tidied").exists()


def test_a_stubborn_process_that_ignores_int_and_term_is_killed_with_what_it_started(stage: Stage) -> None:
    interrupt_when(stage, "up", signal.SIGINT)
    stages = [(signal.SIGINT, 0.1), (signal.SIGTERM, 0.1), (signal.SIGKILL, 20.0)]
    verdict = stage.run({"sim": "stubborn child ready mark=up", "agent": ""}, stop_stages=stages)
    assert verdict.exit_code == 130
    assert stage.orphans() == []


def test_a_frozen_process_may_end_by_itself_as_well(stage: Stage) -> None:
    interrupt_when(stage, "sim.freezes", signal.SIGTERM)
    assert stage.run({"sim": "tidy freeze", "agent": ""}).exit_code == 130
    assert (stage.folder / "tidied").exists()
    assert stage.orphans() == []


def test_why_a_mission_had_no_success_is_what_the_agent_said_last(stage: Stage) -> None:
    stage.said = [status("agent", "reporting", detail="there is no way to the box")]
    verdict = stage.run({"sim": "ready", "agent": "ready await=sim exit=1"})
    assert verdict == Verdict(1, "there is no way to the box")


def test_a_second_interrupt_does_not_wait_for_the_stubborn(stage: Stage) -> None:
    before = signal.getsignal(signal.SIGINT)
    with Crew([(signal.SIGINT, 200.0), (signal.SIGTERM, 200.0), (signal.SIGKILL, 20.0)]) as crew:
        argv = (
            sys.executable,
            "-I",
            "-S",
            str(stage.folder / "script.py"),
            "sim",
            str(stage.folder),
            "stubborn",
            "ready",
        )
        crew.start(Command(role="sim", argv=argv, log=stage.folder / "sim.log", environment=os.environ))
        while not (stage.folder / "sim").exists():
            crew.next_event(0.01)
        os.kill(os.getpid(), signal.SIGINT)
        os.kill(os.getpid(), signal.SIGTERM)
        crew.stop()
        assert crew.running() == ()
    assert signal.getsignal(signal.SIGINT) is before
    assert stage.orphans() == []


def test_what_a_dead_process_left_behind_ends_with_it(stage: Stage) -> None:
    assert stage.run({"sim": "child ready kill=1 mark=again", "agent": "await=again exit=0"}) == Verdict(0)
    assert len(stage.pids("sim")) == 4
    assert stage.orphans() == []
