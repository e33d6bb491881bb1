"""Films the episodes that a training kept, one after the other, each in a process of its own."""

import subprocess
import sys
from pathlib import Path
from typing import Final

from rich.console import Console
from rich.text import Text

from agent_proc.learning.films import VIDEO_FILE, unfilmed
from legpush.errors import NO_OPENGL

LONGEST_S: Final = 900.0
"""Give up a film that takes longer."""


def render_films(folder: Path, console: Console) -> None:
    """Film what has no film yet in the folder of a training, and say what was written, or why it was not."""
    for place in unfilmed(folder):
        command = [sys.executable, "-P", "-m", "sim_proc.render", str(place)]
        try:
            done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=LONGEST_S)
        except subprocess.TimeoutExpired:
            console.print(Text(f"no film of {place}: it was not ready after {LONGEST_S:g} s"), soft_wrap=True)
            continue
        last = (done.stderr.strip().splitlines() or [f"exit code {done.returncode}"])[-1]
        said = f"wrote {place / VIDEO_FILE}" if done.returncode == 0 else f"no film of {place}: {last}"
        console.print(Text(said), soft_wrap=True)
        if done.returncode == NO_OPENGL:
            return
