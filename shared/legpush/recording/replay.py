"""`legpush replay`: verify a recording, let it take the part of a process, or publish it again."""

import logging
import sys
from contextlib import ExitStack
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter

from rich.console import Console

from legpush.bus import Bus
from legpush.errors import RecordingError, StopRequestedError
from legpush.launch.display import make_display
from legpush.launch.recordings import ReplayOptions
from legpush.launch.sims import SimPool
from legpush.lockstep_client import PastStep, SimLink
from legpush.messages import Motion, Outcome, Reset
from legpush.recording.episodes import read_episodes
from legpush.recording.mcap_reader import read_recording
from legpush.recording.verify import Verified, verify
from legpush.robot import CONTROL_PERIOD_S
from legpush.service import stop_on_signals

RUN = "verify"


def replay(options: ReplayOptions) -> int:
    """Do what the options say; the exit code."""
    logging.basicConfig(level=logging.ERROR)
    if options.verify:
        return verify_files(options.files, Console())
    raise RecordingError("Expected --verify")


def verify_files(files: tuple[Path, ...], console: Console) -> int:
    """Compare with a simulator process of its own; 0 where it is identical, 1 where not."""
    recording = read_recording(files)
    episodes = read_episodes(recording)
    if not any(episode.carried_out() or episode.damage for episode in episodes):
        raise RecordingError(
            f"{files[0]}: expected a recording with an episode from its reset on, got one of "
            f"{len(recording.messages)} messages without"
        )
    stop = stop_on_signals()
    began = perf_counter()
    with ExitStack() as stack:
        logs = Path(stack.enter_context(TemporaryDirectory(prefix="legpush-verify-")))
        pool = stack.enter_context(SimPool(1, logs, stop, run=RUN))
        bus = stack.enter_context(Bus(RUN, "agent", "main", pool.endpoints))
        display = stack.enter_context(make_display(console))
        world = LinkedWorld(SimLink(bus, pool.names[0], stop=stop))
        bus.announce()
        try:
            verified = verify(episodes, world.step, lambda text: display.progress("verifying", None, text, ""))
        except StopRequestedError as error:
            raise StopRequestedError("interrupted: not verified") from error
    sys.stdout.write(_words(verified, perf_counter() - began))
    if verified.divergence is None and not recording.is_complete:
        notes = recording.completeness.get("notes") or "its recorder did not come to an end"
        sys.stdout.write("the recording is not complete: " + "; ".join(notes.splitlines()) + "\n")
    return 0 if verified.divergence is None else 1


def _words(verified: Verified, wall_s: float) -> str:
    """What came out, for people."""
    if verified.divergence is not None:
        return f"{verified.divergence}\n"
    seconds = verified.n_ticks * CONTROL_PERIOD_S
    return f"identical: {verified.n_steps} steps, {seconds:.1f} s simulated in {wall_s:.1f} s\n"


class LinkedWorld:
    """A simulator on the bus, where a `Reset` begins a new episode."""

    def __init__(self, link: SimLink) -> None:
        self._link = link
        self._past: list[PastStep] = []

    def step(self, motion: Motion, *, with_trace: bool) -> Outcome:
        """Carry out one motion."""
        if isinstance(motion, Reset):
            self._past = []
            self._link.begin()
        outcome = self._link.step(motion, self._past, with_trace=with_trace)
        self._past.append(PastStep(motion, outcome.state_crc))
        return outcome
