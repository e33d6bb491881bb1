"""Frames of a world for a process that draws nothing itself: another process draws them, with an OpenGL of its own.

A simulator loads MuJoCo without OpenGL, so that no wrong setting of it can stop a simulation. So a process that
simulates asks `sim_proc.render.stills` for pictures, over a pipe: each state is a message behind its length, and each
answer the pixels of a frame.
"""

import os
import subprocess
import weakref
from typing import IO, Final

import msgspec
import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from legpush.errors import ConfigError, one_line
from legpush.messages.stepping import Motion, Outcome, Reset
from legpush.processes.environment import child_environment
from legpush.processes.start_program import program_command

LENGTH_BYTES: Final = 4
LONGEST_END_S: Final = 10.0
"""Longest time in which the process that draws may end."""


class Shown(Struct, frozen=True):
    """A step of the world that is drawn."""

    motion: Motion
    outcome: Outcome
    draw: bool
    """Whether to answer with a frame."""


def write_shown(stream: IO[bytes], shown: Shown) -> None:
    """Write a step to a pipe."""
    data = msgspec.msgpack.encode(shown)
    stream.write(len(data).to_bytes(LENGTH_BYTES, "big") + data)
    stream.flush()


def read_shown(stream: IO[bytes]) -> Shown | None:
    """Read a step from a pipe; None at its end."""
    length = stream.read(LENGTH_BYTES)
    if len(length) < LENGTH_BYTES:
        return None
    return msgspec.msgpack.decode(stream.read(int.from_bytes(length, "big")), type=Shown)


class Frames:
    """Draws the present state of one world; the process that draws starts with the first frame."""

    def __init__(self, width: int, height: int) -> None:
        """`width` and `height` of a frame in pixels."""
        self.size = (width, height)
        self._process: subprocess.Popen[bytes] | None = None
        self._reset: tuple[Motion, Outcome] | None = None
        self._last: tuple[Motion, Outcome] | None = None
        self._sent: object = None
        """The reset that the process knows."""

    def note(self, motion: Motion, outcome: Outcome) -> None:
        """Take the present state of the world."""
        self._last = (motion, outcome)
        if isinstance(motion, Reset):
            self._reset = self._last

    def frame(self) -> NDArray[np.uint8]:
        """Draw the present state, (height, width, 3).

        Raises:
            ConfigError: There is no state yet, or nothing can be drawn here; says why.
        """
        if self._reset is None or self._last is None:
            raise ConfigError("Expected a reset before the first frame: there is nothing to draw")
        process = self._process or self._start()
        width, height = self.size
        n_bytes = width * height * 3
        try:
            if self._sent is not self._reset and self._last is not self._reset:
                write_shown(_pipe(process.stdin), Shown(*self._reset, draw=False))
            self._sent = self._reset
            write_shown(_pipe(process.stdin), Shown(*self._last, draw=True))
            pixels = _pipe(process.stdout).read(n_bytes)
        except OSError:
            pixels = b""
        if len(pixels) < n_bytes:
            said = _pipe(process.stderr).read().decode(errors="replace").strip()
            self.close()
            raise ConfigError(f"Expected a frame, but nothing can be drawn: {one_line(said) or 'the process ended'}")
        return np.frombuffer(pixels, dtype=np.uint8).reshape(height, width, 3)

    def close(self) -> None:
        """End the process that draws."""
        process, self._process, self._sent = self._process, None, None
        if process is not None:
            _end(process)

    def _start(self) -> "subprocess.Popen[bytes]":
        arguments = tuple(map(str, self.size))
        self._process = subprocess.Popen(
            program_command("sim_proc.render.stills", arguments),
            env=child_environment(os.environ),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
        )
        weakref.finalize(self, _end, self._process)
        return self._process


def _end(process: "subprocess.Popen[bytes]") -> None:
    """Close the pipes, which ends the process, and wait for it."""
    for stream in (process.stdin, process.stdout, process.stderr):
        if stream is not None:
            try:
                stream.close()
            except OSError:
                continue
    try:
        process.wait(LONGEST_END_S)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()


def _pipe(stream: IO[bytes] | None) -> IO[bytes]:
    """Return a pipe of a process that was started with pipes."""
    if stream is None:
        raise ConfigError("Expected a pipe to the process that draws, got none")
    return stream
