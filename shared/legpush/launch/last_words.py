"""The last words of a process that failed, as its launcher repeats them."""

import errno
import os
import signal
from typing import Final

from legpush.errors import DISK_FULL, NO_OPENGL
from legpush.processes.child import TAIL_LINES, Process

ERROR: Final = "error: "
"""How a program begins the line that says why it ends; further lines are indented as far."""
EXPLAINED: Final = (2, DISK_FULL, NO_OPENGL)
"""Exit codes of ends that one line explains; the lines before it, such as a traceback, add nothing."""


def error_of(process: Process) -> str:
    """Return the line with which the process said why it ended, or its last line; empty if it wrote nothing.

    A full disk may be full for the log as well, and then only the exit code says why.
    """
    words = process.last_words()
    if process.exit_code == DISK_FULL and not any(line.startswith(ERROR) for line in words):
        return f"{os.strerror(errno.ENOSPC)}, also not for its log"
    told = next((line for line in reversed(words) if line.startswith(ERROR)), words[-1] if words else "")
    return told.removeprefix(ERROR)


def said(process: Process, n_lines: int = TAIL_LINES) -> str:
    """Return the end of a process's log with its path, to follow a sentence about its end.

    It is the one line of an error if that explains the end, and otherwise up to `n_lines`. After SIGKILL there are no
    last words.
    """
    log = process.command.log
    if process.exit_code == -signal.SIGKILL:
        return f"; its log is {log}"
    if process.exit_code in EXPLAINED and (error := error_of(process)):
        return f": {error}; its log is {log}"
    words = process.last_words(n_lines)
    if not words:
        return f"; it wrote nothing to {log}"
    return "\n".join((f"; the end of {log}:", *(f"    {line}" for line in words)))
