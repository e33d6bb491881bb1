"""All children of a launcher: their ends and signals in one queue, and nothing left on exit."""

import os
import signal
import sys
from pathlib import Path
from time import monotonic

import pytest

from legpush.processes.child import Command, Process
from legpush.processes.crew import Crew, Interrupt

WAITS = "import signal; print('up', flush=True); signal.pause()"
STUBBORN = "import signal; signal.signal(signal.SIGINT, signal.SIG_IGN); " + WAITS


def command(folder: Path, role: str, code: str) -> Command:
    argv = (sys.executable, "-I", "-S", "-c", code)
    return Command(role=role, argv=argv, log=folder / f"{role}.log", environment=os.environ)


def start(crew: Crew, folder: Path, role: str, code: str) -> Process:
    """A process that is up."""
    process = crew.start(command(folder, role, code))
    until = monotonic() + 20.0
    while not process.last_words() and monotonic() < until:
        assert crew.next_event(0.01) is None
    return process


def test_the_end_of_a_process_is_an_event(tmp_path: Path) -> None:
    with Crew() as crew:
        codes = {"a": 3, "b": 4}
        processes = {crew.start(command(tmp_path, role, f"raise SystemExit({code})")) for role, code in codes.items()}
        ended = {crew.next_event(20.0), crew.next_event(20.0)}
        assert ended == processes
        assert {process.exit_code for process in processes} == {3, 4}
        assert crew.next_event(0.0) is None
        assert crew.running() == ()


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_signal_to_the_launcher_is_an_event_and_its_handler_is_put_back(number: signal.Signals) -> None:
    before = signal.getsignal(number)
    with Crew() as crew:
        os.kill(os.getpid(), number)
        assert crew.next_event(20.0) == Interrupt(number)
    assert signal.getsignal(number) is before


def test_on_exit_all_processes_are_ended_by_the_mildest_signal_that_works(tmp_path: Path) -> None:
    with Crew([(signal.SIGINT, 0.3), (signal.SIGTERM, 20.0), (signal.SIGKILL, 20.0)]) as crew:
        polite, stubborn = start(crew, tmp_path, "polite", WAITS), start(crew, tmp_path, "stubborn", STUBBORN)
        assert set(crew.running()) == {polite, stubborn}
    assert polite.exit_code in (1, -signal.SIGINT)
    assert stubborn.exit_code == -signal.SIGTERM


def test_a_signal_while_they_end_skips_a_stage(tmp_path: Path) -> None:
    with Crew([(signal.SIGINT, 200.0), (signal.SIGTERM, 20.0), (signal.SIGKILL, 20.0)]) as crew:
        stubborn = start(crew, tmp_path, "stubborn", STUBBORN)
        os.kill(os.getpid(), signal.SIGINT)
        crew.stop()
        assert stubborn.exit_code == -signal.SIGTERM
        assert crew.running() == ()
