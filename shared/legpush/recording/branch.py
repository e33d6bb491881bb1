"""The past of a branch: requests and answers of a recorded episode before the step at which the branch begins."""

from collections.abc import Sequence
from typing import NamedTuple

from msgspec.structs import replace

from legpush.errors import MotionError, RecordingError
from legpush.fields import episode_and_step
from legpush.messages.planning import Plan, PlanQuery
from legpush.messages.stepping import Alter, Motion, Outcome
from legpush.numerics.computed_with import told
from legpush.recording.episodes import Asked, EpisodeRecord, read_episodes
from legpush.recording.facts import STILL, recorded_with
from legpush.recording.mcap_file.contents import Recording
from legpush.recording.plans import query_bytes, read_plans
from legpush.recording.play import RecordedPlanner, instead


class BranchPoint(NamedTuple):
    """The step at which a branch begins; the steps before it are the recorded ones."""

    episode: int
    step: int

    def __str__(self) -> str:
        """Return the text that `--at` takes."""
        return f"{self.episode}:{self.step}"


def parse_point(text: str) -> BranchPoint:
    """Parse `EPISODE:STEP`.

    Raises:
        ConfigError: The text is something else.
    """
    return BranchPoint(*episode_and_step(text, "--at"))


class RecordedPast:
    """Gives the answers of a recording up to a branch point."""

    def __init__(self, recording: Recording, at: BranchPoint, alter: Alter | None = None) -> None:
        """Read the past of the branch point; `alter` changes the box there.

        Raises:
            RecordingError: The recording has no such point, or something before it is damaged.
        """
        episodes = read_episodes(recording)
        if at.episode >= len(episodes):
            raise RecordingError(f"Expected an episode {_range(0, len(episodes) - 1)} for --at, got {at.episode}")
        self._episode = episodes[at.episode]
        n_done = len(self._episode.carried_out())
        for damage in self._episode.damage:
            if damage.step < at.step:
                raise RecordingError(
                    f"{self._episode.label}, step {damage.step}: its {damage.field} is damaged: got {damage.got}"
                )
        if not 1 <= at.step <= n_done:
            raise RecordingError(f"Expected a step {_range(1, n_done)} of episode {at.episode} for --at, got {at.step}")
        self.n_steps = at.step
        self.alter = alter
        self.computed_with = recorded_with(recording)
        self.still = STILL
        records = read_plans(recording)
        self._plans = {query_bytes(record.query): record.plans for record in records}
        self._planner = RecordedPlanner(records, self.computed_with)
        self._others = [episode for episode in episodes if episode is not self._episode]

    def act(self, step: int, motion: Motion, *, with_trace: bool) -> Outcome:
        """Return the recorded outcome of this motion at this step.

        Raises:
            RecordingError: Another motion was recorded.
            OtherVersionError: Another motion was recorded, by another version.
            MotionError: The recorded simulator refused the motion.
        """
        asked = next((one for one in self._episode.steps[step] if one.motion == motion), None)
        if asked is None:
            difference = (
                f"step {step} of the recording: {instead([self._episode], step, motion)}; the recorded decision "
                "depended on something that is not in the recording, such as another version of legpush"
            )
            raise told(RecordingError(difference), self.computed_with, STILL)
        outcome = asked.outcome
        if outcome is None:
            raise MotionError(asked.refusal or "not answered")
        return self._with_trace(step, asked, outcome) if with_trace else replace(outcome, trace=None)

    def plan(self, query: PlanQuery) -> Plan:
        """Return the first recorded answer.

        Raises:
            RecordingError: The query was not recorded.
            OtherVersionError: It was not, and the recording is of another version.
        """
        return self.revision(query, 0)

    def revision(self, query: PlanQuery, revision: int) -> Plan:
        """Return the recorded answer with this number, or the last one.

        Raises:
            RecordingError: The query was not recorded.
            OtherVersionError: It was not, and the recording is of another version.
        """
        plans = self._plans.get(query_bytes(query))
        if plans is None:
            raise self._planner.unknown(query)
        return plans[min(revision, max(plans))]

    def _with_trace(self, step: int, asked: Asked, outcome: Outcome) -> Outcome:
        """Return the outcome with its trace, if any episode has it.

        A simulator that repeats steps after a restart does not send it.
        """
        if outcome.trace is not None:
            return outcome
        for episode in self._others:
            if _motions(episode, step) == _motions(self._episode, step):
                for one in episode.steps[step]:
                    traced = one.outcome if one.motion == asked.motion else None
                    if traced is not None and traced.trace is not None:
                        return traced
        return outcome


def _motions(episode: EpisodeRecord, last: int) -> Sequence[Motion]:
    return [asked.motion for asked in episode.carried_out()[: last + 1]]


def _range(first: int, last: int) -> str:
    return f"from {first} to {last}" if last >= first else "(there is none)"
