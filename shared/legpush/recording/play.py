"""Plays a recording in the place of a simulator or a planner: `python -m legpush.recording.play ROLE FILE... [FLAGS]`.

It gives the recorded answers, and ends with an error if it gets a request that was not recorded.
"""

import sys
import threading
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from time import sleep
from typing import Annotated, Final, Literal

from msgspec.structs import replace

from legpush.arguments import Positional, arg
from legpush.bus.bus import Bus
from legpush.errors import LegpushError, MotionError, RecordingError
from legpush.lockstep.server import serve_actions
from legpush.messages.planning import Plan, PlanQuery
from legpush.messages.stepping import Motion, Outcome, Reset
from legpush.numerics.computed_with import ComputedWith, told
from legpush.plans.planner import Interrupted, PlanningInterruptedError
from legpush.plans.server import serve_plans
from legpush.recording.episodes import EpisodeRecord, difference, read_episodes
from legpush.recording.facts import STILL, recorded_with
from legpush.recording.mcap_file.reader import read_recording
from legpush.recording.plans import RecordedPlans, query_bytes, read_plans
from legpush.service import ServiceConfig, run_process

IDLE_S: Final = 0.01


@dataclass(frozen=True, kw_only=True)
class PlayConfig(ServiceConfig):
    """Options of any process, and the recording to play."""

    files: Positional[Annotated[tuple[Path, ...], arg("FILE")]] = ()
    """The recording, or its parts."""


class RecordedSim:
    """A simulator that knows only the recorded episodes."""

    def __init__(self, episodes: Sequence[EpisodeRecord], recorded: ComputedWith) -> None:
        """`recorded` is what the episodes were computed with."""
        self._episodes = episodes
        self._recorded = recorded
        self._candidates: list[EpisodeRecord] = []
        self._step = 0

    def perform(self, motion: Motion, *, with_trace: bool) -> Outcome:
        """Return the recorded answer to a motion.

        Raises:
            MotionError: The recorded simulator refused the motion.
            RecordingError: Another motion was recorded.
            OtherVersionError: Another motion was recorded, by another version.
        """
        step = 0 if isinstance(motion, Reset) else self._step
        among = self._episodes if step == 0 else self._candidates
        fitting = [
            (episode, asked)
            for episode in among
            for asked in episode.steps.get(step, [])
            if asked.motion == motion and asked.is_told
        ]
        answered = [(episode, asked) for episode, asked in fitting if asked.answer is not None]
        outcomes = (asked.outcome for _, asked in answered)
        outcome = next((one for one in outcomes if one is not None and (one.trace or not with_trace)), None)
        refusal = next((asked.refusal for _, asked in fitting if asked.answer is None), None)
        if outcome is None:
            if refusal is not None and not answered:
                raise MotionError(refusal)
            difference = f"step {step}: {instead(among, step, motion, with_trace=with_trace)}"
            raise told(RecordingError(difference), self._recorded, STILL)
        self._candidates, self._step = [episode for episode, _ in answered], step + 1
        return outcome if with_trace else replace(outcome, trace=None)


def instead(among: Sequence[EpisodeRecord], step: int, motion: Motion, *, with_trace: bool = False) -> str:
    """Return a text that says what the recording has in the place of a motion."""
    asked = [one for episode in among for one in episode.steps.get(step, []) if one.is_told]
    if not asked:
        return f"the recording ends before it, got {type(motion).__name__.lower()}"
    recorded = asked[-1].motion
    if type(recorded) is not type(motion):
        return f"expected {type(recorded).__name__.lower()} as recorded, got {type(motion).__name__.lower()}"
    if recorded == motion and with_trace:
        return "expected a request without a trace, which the recording lacks here, got a request with one"
    path, expected, got = difference(recorded, motion)
    return f"expected {type(motion).__name__.lower()} with {path} {expected} as recorded, got {got}"


class RecordedPlanner:
    """A planner that knows only the recorded queries."""

    def __init__(self, records: Sequence[RecordedPlans], recorded: ComputedWith) -> None:
        """`recorded` is what the plans were computed with."""
        self._records = records
        self._recorded = recorded
        self._plans = {query_bytes(record.query): record.plans for record in records}

    def make_plans(self, query: PlanQuery, interrupted: Interrupted) -> Iterator[Plan]:
        """Yield the recorded answers, then wait to be interrupted, like a planner that is still planning.

        Raises:
            RecordingError: The query was not recorded.
            OtherVersionError: It was not, and the recording is of another version.
            PlanningInterruptedError: `interrupted` returned True.
        """
        plans = self._plans.get(query_bytes(query))
        if plans is None:
            raise self.unknown(query)
        for revision in sorted(plans):
            yield plans[revision]
        while not interrupted():
            sleep(IDLE_S)
        raise PlanningInterruptedError

    def unknown(self, query: PlanQuery) -> LegpushError:
        """Return the error of a query that was not recorded, which says what was recorded instead."""
        return told(RecordingError(self._instead(query)), self._recorded, STILL)

    def _instead(self, query: PlanQuery) -> str:
        same_kind = [record.query for record in self._records if type(record.query) is type(query)]
        if not same_kind:
            return f"the recording answers no {type(query).__name__}"
        path, expected, got = difference(same_kind[-1], query)
        return f"the recording has no such query; it differs from the last one of its kind in {path}: {expected}, {got}"


def main() -> int:
    """Take the part of the process whose role is the first argument; returns the exit code."""
    role: Literal["sim", "planner"] = "sim" if sys.argv.pop(1) == "sim" else "planner"

    def serve(config: PlayConfig, bus: Bus, stop: threading.Event) -> None:
        recording = read_recording(config.files)
        recorded = recorded_with(recording)
        if role == "sim":
            serve_actions(bus, RecordedSim(read_episodes(recording), recorded), stop)
        else:
            serve_plans(bus, RecordedPlanner(read_plans(recording), recorded).make_plans, stop)

    return run_process(role, PlayConfig, serve)
