"""One child process: what it leaves in its log, how it ends, and that nothing of it stays."""

import os
import queue
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import psutil
import pytest

from legpush.processes.child import Command, Process, describe_exit
from tests.legpush.fakes import eventually


def command(folder: Path, code: str) -> Command:
    """A process that runs this code."""
    argv = (sys.executable, "-I", "-S", "-c", code)
    return Command(role="sim", argv=argv, log=folder / "log", environment={"GREETING": "hello"})


def run(folder: Path, code: str) -> Process:
    """The process, after it has ended."""
    ended: queue.Queue[Process] = queue.Queue()
    process = Process(command(folder, code), ended.put)
    assert ended.get(timeout=20.0) is process
    return process


@pytest.mark.parametrize(("code", "words"), [(3, "exited with 3"), (-9, "was killed by SIGKILL")])
def test_how_a_process_ended_is_said_in_words(code: int, words: str) -> None:
    assert describe_exit(code) == words


@pytest.mark.parametrize(
    ("code", "exit_code"), [("pass", 0), ("raise SystemExit(7)", 7), ("import os; os.kill(os.getpid(), 9)", -9)]
)
def test_its_exit_code_is_known_when_it_has_ended(tmp_path: Path, code: str, exit_code: int) -> None:
    assert run(tmp_path, code).exit_code == exit_code


def test_its_last_words_are_those_of_this_life_without_empty_lines(tmp_path: Path) -> None:
    run(tmp_path, "print('before')")
    process = run(tmp_path, "import sys; print('a\\n\\n  b  ', flush=True); sys.stderr.write('c\\n')")
    assert process.last_words() == ("a", "  b", "c")
    assert process.last_words(2) == ("  b", "c")


def test_its_last_words_are_whole_even_if_they_are_long(tmp_path: Path) -> None:
    process = run(tmp_path, "print('x' * 300); print('first words ' + 'y' * 30_000 + ' last')")
    (said,) = process.last_words(1)
    assert said.startswith("first words y")
    assert said.endswith("y last")
    assert process.last_words(5) == ("x" * 300, said)


def test_it_has_the_environment_that_it_is_given_and_no_input(tmp_path: Path) -> None:
    process = run(tmp_path, "import os, sys; print(os.environ['GREETING'], repr(sys.stdin.read()))")
    assert process.last_words() == ("hello ''",)


def test_what_it_started_ends_with_it(tmp_path: Path) -> None:
    waits = "import signal; signal.pause()"
    code = f"import subprocess, sys; print(subprocess.Popen([sys.executable, '-c', {waits!r}]).pid)"
    (pid,) = map(int, run(tmp_path, code).last_words())
    assert eventually(lambda: not psutil.pid_exists(pid) or psutil.Process(pid).status() == psutil.STATUS_ZOMBIE)


def test_a_signal_reaches_it_and_is_nothing_once_it_has_ended(tmp_path: Path) -> None:
    ended: queue.Queue[Process] = queue.Queue()
    process = Process(command(tmp_path, "import signal; signal.pause()"), ended.put)
    assert psutil.pid_exists(process.pid)
    process.signal(signal.SIGTERM)
    assert ended.get(timeout=20.0).exit_code == -signal.SIGTERM
    process.signal(signal.SIGTERM)


def test_it_is_frozen_from_a_stop_to_the_signal_to_go_on(tmp_path: Path) -> None:
    ended: queue.Queue[Process] = queue.Queue()
    process = Process(command(tmp_path, "import signal; signal.pause()"), ended.put)
    assert not process.is_frozen()
    process.signal(signal.SIGSTOP)
    assert eventually(process.is_frozen)
    process.signal(signal.SIGCONT)
    assert eventually(lambda: not process.is_frozen())
    process.signal(signal.SIGKILL)
    ended.get(timeout=20.0)
    assert not process.is_frozen()


def test_a_command_that_is_tried_again_has_its_further_flags_once(tmp_path: Path) -> None:
    first = Command(role="sim", argv=("a",), log=tmp_path / "log", environment=os.environ, flags_again=("--recorded",))
    again = first.again()
    assert again.argv == again.again().argv == ("a", "--recorded")


def test_one_that_died_before_it_opened_its_group_has_an_exit_code_too(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def start_in_our_group(argv: list[str], *, start_new_session: bool, **others: Any) -> subprocess.Popen[bytes]:
        assert start_new_session
        return popen(argv, **others)

    popen = subprocess.Popen
    monkeypatch.setattr(subprocess, "Popen", start_in_our_group)
    ended: queue.Queue[Process] = queue.Queue()
    process = Process(command(tmp_path, "import signal; signal.pause()"), ended.put)
    process.signal(signal.SIGINT)
    os.kill(process.pid, signal.SIGKILL)
    assert ended.get(timeout=20.0).exit_code == -signal.SIGKILL
