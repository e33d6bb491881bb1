"""What is repeated of the log of a process that failed."""

import os
import sys
from pathlib import Path

import pytest

from legpush.launch.last_words import error_of, said
from legpush.processes.child import Command, Process
from legpush.processes.crew import Crew

TRACEBACK = "print('Traceback (most recent call last):'); print('  File'); print('KeyError: 1')"


def ended(folder: Path, code: str) -> Process:
    argv = (sys.executable, "-I", "-S", "-c", code)
    with Crew() as crew:
        process = crew.start(Command(role="agent", argv=argv, log=folder / "agent.log", environment=os.environ))
        assert crew.next_event(20.0) is process
    return process


@pytest.mark.parametrize(
    ("code", "words"),
    [
        ("print('a'); print('error: b'); print('leaked c'); raise SystemExit(2)", ": b; its log is {log}"),
        ("print('a'); print('b'); raise SystemExit(2)", ": b; its log is {log}"),
        ("print('a'); print('error: b'); raise SystemExit(5)", ": b; its log is {log}"),
        (
            "print('a'); print('b'); raise SystemExit(5)",
            ": No space left on device, also not for its log; its log is {log}",
        ),
        ("raise SystemExit(2)", "; it wrote nothing to {log}"),
        ("print('a'); print('error: b'); raise SystemExit(3)", "; the end of {log}:\n    a\n    error: b"),
        (
            f"{TRACEBACK}; raise SystemExit(1)",
            "; the end of {log}:\n    Traceback (most recent call last):\n      File\n    KeyError: 1",
        ),
        ("import os; print('a', flush=True); os.kill(os.getpid(), 9)", "; its log is {log}"),
    ],
)
def test_an_error_is_its_line_and_a_fault_is_the_end_of_the_log(code: str, words: str, tmp_path: Path) -> None:
    assert said(ended(tmp_path, code)) == words.format(log=tmp_path / "agent.log")


def test_a_long_log_is_bounded(tmp_path: Path) -> None:
    process = ended(tmp_path, "for n in range(10_000): print('line', n)\nraise SystemExit(3)")
    assert said(process).splitlines()[1:] == [f"    line {n}" for n in range(9988, 10_000)]
    assert said(process, 2).splitlines()[1:] == ["    line 9998", "    line 9999"]
    assert error_of(process) == "line 9999"
