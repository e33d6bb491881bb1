"""A process that is started through the watch ends with the process that started it."""

import subprocess
import sys

import psutil

from legpush.processes import parent_watch
from tests.legpush.fakes import eventually

PARENT = """
import os, subprocess, sys
waits = [sys.executable, "-c", "import signal; signal.pause()"]
child = subprocess.Popen([sys.executable, "-I", "-S", sys.argv[1], str(os.getpid()), *waits])
print(child.pid, flush=True)
sys.stdin.read()
"""


def test_a_child_does_not_outlive_a_parent_that_is_killed() -> None:
    argv = [sys.executable, "-c", PARENT, parent_watch.__file__]
    with subprocess.Popen(argv, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as parent:
        assert parent.stdout is not None
        child = psutil.Process(int(parent.stdout.readline()))
        assert eventually(lambda: parent_watch.__file__ not in child.cmdline())
        parent.kill()
        parent.wait(20.0)
    assert eventually(lambda: not child.is_running() or child.status() == psutil.STATUS_ZOMBIE)


def test_a_child_whose_parent_is_another_one_by_now_does_not_begin() -> None:
    parent = "999999999"
    argv = [sys.executable, "-I", "-S", parent_watch.__file__, parent, sys.executable, "-c", "print('began')"]
    done = subprocess.run(argv, capture_output=True, text=True, timeout=60.0, check=False)
    assert (done.returncode, done.stdout) == (0, "")
