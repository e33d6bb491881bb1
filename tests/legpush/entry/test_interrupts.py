"""What a signal does to a program while it loads, works, and ends."""

from pathlib import Path
from signal import SIGINT

import pytest

from tests.legpush.entry.programs import Ended, run

SIGNALS = ("signal.SIGINT", "signal.SIGTERM")
PROGRAMS = ("agent_proc", "planner_proc", "planner_proc.conformance", "sim_proc", "sim_proc.view", "legpush.entry")
INTERRUPTED_WHILE_LOADING = """
import os, runpy, signal, sys

class Interrupting:
    def find_spec(self, name, path=None, target=None):
        if name == "legpush.entry.program":
            os.kill(os.getpid(), signal.SIGINT)

sys.meta_path.insert(0, Interrupting())
"""


@pytest.mark.parametrize("number", SIGNALS)
def test_a_program_that_loads_ends_at_once(number: str, tmp_path: Path) -> None:
    assert run(tmp_path, f"interrupt({number})\nprint('loaded')\nmain = int") == Ended(130, "", "")


@pytest.mark.parametrize("program", PROGRAMS)
def test_a_program_that_does_not_handle_signals_yet_ends_without_a_word(program: str, tmp_path: Path) -> None:
    begin = f"sys.argv.append('work')\nrunpy.run_module({program!r}, run_name='__main__')"
    assert run(tmp_path, "", INTERRUPTED_WHILE_LOADING + begin) == Ended(-SIGINT, "", "")


def test_the_command_line_that_does_not_handle_signals_yet_ends_without_a_word(tmp_path: Path) -> None:
    begin = "from legpush.cli import main\nmain()"
    assert run(tmp_path, "", INTERRUPTED_WHILE_LOADING + begin) == Ended(-SIGINT, "", "")


def test_an_interrupt_that_is_ignored_stays_so_until_a_program_handles_it(tmp_path: Path) -> None:
    ignored = "signal.signal(signal.SIGINT, signal.SIG_IGN)\n"
    begin = "from legpush.entry import run_main\nsys.exit(run_main('work'))"
    assert run(tmp_path, "def main():\n    return 4", INTERRUPTED_WHILE_LOADING + ignored + begin) == Ended(4, "", "")


@pytest.mark.parametrize("number", SIGNALS)
def test_work_that_is_interrupted_is_tidied_up(number: str, tmp_path: Path) -> None:
    work = f"""
def main():
    try:
        interrupt({number})
        time.sleep(60)
    finally:
        print("tidied")
"""
    assert run(tmp_path, work) == Ended(130, "tidied\n", "")


def test_an_interrupt_that_a_library_turns_into_an_error_is_still_one(tmp_path: Path) -> None:
    work = """
def main():
    try:
        interrupt()
        time.sleep(60)
    except BaseException as error:
        raise ImportError("numpy is broken") from error
"""
    assert run(tmp_path, work) == Ended(130, "", "")


def test_an_interrupt_in_a_finalizer_is_not_lost(tmp_path: Path) -> None:
    work = """
class Closing:
    def __del__(self):
        interrupt()
        for _ in range(1000):
            pass

def main():
    Closing()
    time.sleep(60)
"""
    assert run(tmp_path, work) == Ended(130, "", "")


def test_another_error_in_a_finalizer_is_printed_as_usual(tmp_path: Path) -> None:
    work = """
class Closing:
    def __del__(self):
        raise KeyError(1)

def main():
    Closing()
    return 0
"""
    ended = run(tmp_path, work)
    assert (ended.exit_code, ended.out) == (0, "")
    assert "Exception ignored in" in ended.err
    assert "KeyError: 1" in ended.err


def test_after_the_work_a_signal_keeps_its_exit_code_and_what_it_wrote(tmp_path: Path) -> None:
    work = """
import atexit

def end():
    interrupt()
    time.sleep(60)

def main():
    atexit.register(end)
    print("done")
    return 7
"""
    assert run(tmp_path, work) == Ended(7, "done\n", "")


def test_a_signal_between_two_programs_waits_for_the_second_one(tmp_path: Path) -> None:
    work = """
def main():
    from legpush.entry.interrupts import hold
    hold()
    interrupt()
    os.execv(sys.executable, [sys.executable, "-c", SECOND])

SECOND = '''
import time
time.sleep(0.2)
from legpush.entry.program import run_main
print("handles it", flush=True)
run_main("work")
'''
"""
    assert run(tmp_path, work) == Ended(130, "handles it\n", "")


def test_children_that_are_started_meanwhile_are_deaf_and_the_parent_is_not(tmp_path: Path) -> None:
    work = """
import subprocess
from legpush.entry.interrupts import deaf_children

def main():
    code = "import os, signal; os.kill(os.getpid(), signal.SIGINT); print('deaf')"
    try:
        with deaf_children():
            interrupt()
            child = subprocess.Popen([sys.executable, "-c", code])
    finally:
        print(child.wait())
"""
    assert run(tmp_path, work) == Ended(130, "deaf\n0\n", "")


def test_the_first_process_of_multiprocessing_is_deaf_like_the_others(tmp_path: Path) -> None:
    work = """
import multiprocessing, os, signal
from legpush.entry.interrupts import deaf_children

def main():
    for _ in range(2):
        with deaf_children():
            child = multiprocessing.get_context("spawn").Process(target=time.sleep, args=(0.5,))
            child.start()
        blocked = next(line for line in open(f"/proc/{child.pid}/status") if line.startswith("SigBlk"))
        print(int(blocked.split()[1], 16) >> (signal.SIGINT - 1) & 1)
        child.join()
    return 0
"""
    assert run(tmp_path, work) == Ended(0, "1\n1\n", "")


def test_a_process_that_starts_is_known_before_its_parent_is_interrupted_even_beside_threads(tmp_path: Path) -> None:
    work = """
import subprocess, threading
from legpush.entry.interrupts import deaf_children

def main():
    threading.Thread(target=time.sleep, args=(60,), daemon=True).start()
    try:
        with deaf_children():
            interrupt()
            time.sleep(0.2)
            print("all started")
    finally:
        print("tidied")
"""
    assert run(tmp_path, work) == Ended(130, "all started\ntidied\n", "")


def test_on_another_thread_nothing_but_the_children_is_deaf(tmp_path: Path) -> None:
    work = """
import threading
from legpush.entry.interrupts import deaf_children

def start():
    with deaf_children():
        time.sleep(60)

def main():
    threading.Thread(target=start, daemon=True).start()
    time.sleep(0.1)
    interrupt()
    time.sleep(60)
"""
    assert run(tmp_path, work) == Ended(130, "", "")
