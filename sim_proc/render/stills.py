"""Draws states of a world one by one, for `legpush.processes.frames`: steps on stdin, pixels on stdout.

Arguments: width and height of a frame in pixels. It ends at the end of its input. First it finds an OpenGL backend, and
then it becomes a new process that loads MuJoCo with this backend: a process that has MuJoCo keeps it as it is.
"""

import os
import sys
from typing import TYPE_CHECKING, Final

from legpush.errors import NO_OPENGL
from legpush.history.timeline import Timeline
from legpush.messages.stepping import Reset
from legpush.processes.frames import Shown, read_shown
from legpush.processes.start_program import program_command
from sim_proc.render.film import Film, film_of

if TYPE_CHECKING:
    from sim_proc.render.camera import Camera

READY: Final = "ready"
"""The argument of the process that draws."""


def main() -> int:
    """Find a backend, or draw until the input ends; returns the exit code."""
    width, height, *ready = sys.argv[1:]
    if ready == [READY]:
        return draw(int(width), int(height))
    from sim_proc.render.backends import use_backend

    if not use_backend("again"):
        return NO_OPENGL
    command = program_command("sim_proc.render.stills", (width, height, READY))
    return os.execv(command[0], command)  # noqa: S606 - no shell is wanted


def draw(width: int, height: int) -> int:
    """Draw until the input ends; returns the exit code."""
    from sim_proc.render.camera import Camera, FrameSize

    camera: Camera | None = None
    history: Timeline | None = None
    filmed: Film | None = None
    while (shown := read_shown(sys.stdin.buffer)) is not None:
        history = extended(history, shown)
        if not shown.draw:
            continue
        film = film_of(history, "a world that is stepped", still=True)
        if camera is None or filmed is None or not same_world(film, filmed):
            _close(camera)
            camera = Camera(film, FrameSize(width=width, height=height))
        filmed = film
        camera.show(film)
        sys.stdout.buffer.write(camera.frame(len(film.qpos) - 1).tobytes())
        sys.stdout.buffer.flush()
    _close(camera)
    return 0


def _close(camera: "Camera | None") -> None:
    if camera is not None:
        camera.close()


def extended(history: Timeline | None, shown: Shown) -> Timeline:
    """Return the history with one more step; a reset begins another one.

    Raises:
        RuntimeError: The first step is no reset.
    """
    if isinstance(shown.motion, Reset):
        history = Timeline(shown.motion.scenario)
    if history is None:
        raise RuntimeError(f"Expected a reset first, got {shown.motion!r}")
    history.add(len(history.steps), shown.motion, shown.outcome, 0)
    return history


def same_world(one: Film, other: Film) -> bool:
    """Return whether two films have the same model."""
    return one.scenario == other.scenario and one.reality == other.reality
