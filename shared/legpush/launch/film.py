"""Films a run in a process of its own, since only a trial shows whether and how a machine can draw."""

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Final

from legpush.errors import INTERRUPTED, NO_OPENGL
from legpush.launch.display import Display
from legpush.launch.last_words import said
from legpush.launch.supervisor import Verdict
from legpush.options.formats import View
from legpush.patience import SLICE_S, Stopwatch
from legpush.processes.child import Command, describe_exit
from legpush.processes.crew import Crew, Interrupt

LONGEST_S: Final = 900.0
"""Give up a film that takes longer."""


def film_arguments(folder: Path, camera: View = "follow") -> tuple[str, ...]:
    """Return the command line that films the run in `folder`."""
    flags = () if camera == "follow" else ("--camera", camera)
    return (sys.executable, "-P", "-m", "sim_proc.render", str(folder), *flags)


def film(
    command: Command, crew: Crew, display: Display, note: Callable[[str], None], longest_s: float = LONGEST_S
) -> Verdict | None:
    """Make the film, or `note` in one line why there is none.

    Returns the verdict of an interrupt, which replaces that of the run; otherwise None.
    """
    process = crew.start(command)
    stopwatch = Stopwatch()
    while process.exit_code is None:
        display.progress("filming", None, "".join(process.last_words(1)), "")
        event = crew.next_event(SLICE_S)
        if isinstance(event, Interrupt):
            crew.stop()
            return Verdict(INTERRUPTED, f"interrupted by {event.by.name} while filming")
        if stopwatch.tick() > longest_s:
            crew.stop()
            note(f"no video: it was not ready after {longest_s:g} s; see {command.log}")
            return None
    if process.exit_code == NO_OPENGL:
        note("".join(process.last_words(1)) or "no video: no OpenGL library can be used")
    elif process.exit_code != 0:
        what = f"no video: the film {describe_exit(process.exit_code)}"
        end = said(process)
        if "\n" in end:
            display.notice(f"{what}{end}")
            end = f"; its log is {command.log}"
        note(f"{what}{end}")
    return None
