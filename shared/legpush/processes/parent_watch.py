"""Run as a script: `parent_watch.py PARENT COMMAND...` becomes COMMAND, which the kernel kills when PARENT dies.

So no process outlives a launcher that was killed. The script imports nothing of the package: it has to start fast.
"""

import ctypes
import os
import signal
import sys

PR_SET_PDEATHSIG = 1


def main(arguments: list[str]) -> None:
    """Ask for the signal, make sure that the parent did not die before, and become the command."""
    parent, *command = arguments
    if die_with(int(parent)):
        os.execv(command[0], command)  # noqa: S606 - no shell is wanted


def die_with(parent: int) -> bool:
    """Ask the kernel to kill this process when its parent dies; returns whether that still lives.

    To the kernel, the parent is the thread that started this process.
    """
    libc = ctypes.CDLL(None, use_errno=True)
    if libc.prctl(PR_SET_PDEATHSIG, signal.SIGKILL) != 0:
        raise OSError(ctypes.get_errno(), "prctl(PR_SET_PDEATHSIG)")
    return os.getppid() == parent


if __name__ == "__main__":
    main(sys.argv[1:])
