"""Films the episodes that a training kept, one after the other, each in a process of its own."""

import subprocess
import sys
import threading
from pathlib import Path
from time import monotonic
from typing import Final

from rich.console import Console
from rich.text import Text

from agent_proc.learning.films import VIDEO_FILE, unfilmed
from legpush.errors import NO_OPENGL

LONGEST_S: Final = 900.0
"""Give up a film that takes longer."""
LOOK_S: Final = 0.2
"""Time between two looks at whether the user has interrupted it."""
END_S: Final = 10.0
"""Time that an interrupted film has to end."""


def render_films(folder: Path, console: Console, again: str, stop: threading.Event) -> bool:
    """Film what has no film yet in the folder of a training, and say what was written, or why it was not.

    `again` is the command that makes the missing films. Returns False if `stop` was set before they were tried.
    """
    for place in unfilmed(folder):
        code, reason = _render(place, stop)
        if code is None and stop.is_set():
            console.print(Text(f"interrupted: films are missing; to make them: {again}"), soft_wrap=True)
            return False
        said = f"wrote {place / VIDEO_FILE}" if code == 0 else f"no film of {place}: {reason}; to try again: {again}"
        console.print(Text(said), soft_wrap=True)
        if code == NO_OPENGL:
            break
    return True


def _render(place: Path, stop: threading.Event) -> tuple[int | None, str]:
    """Film an episode; returns the exit code, None if it was not awaited, and the last line of its errors."""
    command = [sys.executable, "-P", "-m", "sim_proc.render", str(place)]
    began_s = monotonic()
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) as process:
        while not stop.is_set() and monotonic() - began_s < LONGEST_S:
            try:
                _, errors = process.communicate(timeout=LOOK_S)
            except subprocess.TimeoutExpired:
                continue
            if stop.is_set():
                break
            return process.returncode, (errors.strip().splitlines() or [f"exit code {process.returncode}"])[-1]
        process.terminate()
        try:
            process.communicate(timeout=END_S)
        except subprocess.TimeoutExpired:
            process.kill()
    return None, f"it was not ready after {LONGEST_S:g} s"
