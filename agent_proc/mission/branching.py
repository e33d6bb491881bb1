"""Continues a recorded mission: decides as it did up to a step, and differently from there on."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from msgspec.structs import replace

from agent_proc.frames.push_view import PushView
from agent_proc.policies.policy import Policy
from agent_proc.policies.registry import policy_from_data
from legpush.messages.stepping import Alter, Push
from legpush.recording.branch import BranchPoint, RecordedPast
from legpush.recording.facts import read_facts
from legpush.recording.mcap_file.reader import read_recording
from legpush.scene.names import PlannerName
from legpush.scene.scenario import Scenario


@dataclass(frozen=True, kw_only=True)
class Branch:
    """What is repeated up to the branch point, and what is different from it on."""

    past: RecordedPast
    past_policy: Policy
    planner: PlannerName | None = None
    """Planner from the branch point on, instead of the scenario's; None to keep that."""

    def is_past(self, n_steps: int) -> bool:
        """Whether the next step, after `n_steps`, is repeated from the recording."""
        return n_steps < self.past.n_steps

    def scenario(self, scenario: Scenario, n_steps: int) -> Scenario:
        """The scenario that holds after `n_steps`."""
        if self.planner is None or self.is_past(n_steps):
            return scenario
        return replace(scenario, planning=replace(scenario.planning, planner=self.planner))


class BranchPolicy:
    """The policy of the recording up to the branch point, another one from there on."""

    def __init__(self, past: Policy, future: Policy, is_past: Callable[[], bool]) -> None:
        self._past = past
        self._future = future
        self._is_past = is_past

    def decide(self, view: PushView) -> Push | None:
        """The next push cycle."""
        return (self._past if self._is_past() else self._future).decide(view)


def read_branch(
    files: tuple[Path, ...],
    at: BranchPoint,
    *,
    repeated_policy: str | None = None,
    trust_file: bool = False,
    planner: PlannerName | None,
    alter: Alter | None,
) -> Branch:
    """Read the recording to continue from `at` on, with another planner or an altered box.

    A recorded policy that runs code is used only if `repeated_policy` is its name.

    Raises:
        RecordingError: The recording cannot be continued there.
        PolicyError: The recorded policy runs code and was not repeated, is another one, or cannot be used.
    """
    recording = read_recording(files)
    facts = read_facts(recording)
    past = RecordedPast(recording, at, alter)
    policy = policy_from_data(facts.policy, facts.policy_sha256, repeated=repeated_policy, trust_file=trust_file)
    return Branch(past=past, past_policy=policy, planner=planner)
