"""Puts steps and plans together from messages that may come in any order."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from legpush.messages.planning import PlanRequest, PlanResult
from legpush.messages.stepping import Answer, Motion, Outcome, Refusal

EpisodeKey = tuple[str, int]
"""Simulator, episode on the wire."""
StepKey = tuple[str, int, int]
"""Simulator, episode on the wire, step."""


class CompleteStep(NamedTuple):
    """A step of which motion and outcome are known."""

    motion: Motion
    outcome: Outcome
    time_ns: int
    """When it was answered, since 1970."""
    reward: float | None
    """None if it is not known yet."""


@dataclass(kw_only=True)
class _Asked:
    """What is known of a step that is not complete."""

    motions: list[Motion] = field(default_factory=list)
    """The motions that were asked for, one after the other: each but the last has to have been refused."""
    refusals: set[str] = field(default_factory=set)
    """Their reasons: an action that was sent again is refused again."""
    outcome: Outcome | None = None
    time_ns: int = 0


class StepAssembler:
    """Collects motions, answers and rewards until their steps are complete."""

    def __init__(self) -> None:
        self._asked: dict[StepKey, _Asked] = {}
        self._rewards: dict[StepKey, float] = {}

    def add_motion(self, key: StepKey, motion: Motion) -> bool:
        """Add a motion that was asked for as this step; whether it is new."""
        motions = self._asked.setdefault(key, _Asked()).motions
        if motion in motions:
            return False
        motions.append(motion)
        return True

    def add_answer(self, key: StepKey, answer: Answer, time_ns: int) -> None:
        """Add the outcome of this step, or the refusal of one of its motions."""
        asked = self._asked.setdefault(key, _Asked())
        if isinstance(answer, Refusal):
            if answer.cause == "invalid":
                asked.refusals.add(answer.reason)
        elif asked.outcome is None or asked.outcome.trace is None:
            asked.outcome, asked.time_ns = answer.outcome, time_ns

    def add_reward(self, key: StepKey, value: float) -> None:
        """Add what this step earned."""
        self._rewards[key] = value

    def complete(self, key: StepKey) -> CompleteStep | None:
        """Return this step if it is complete."""
        asked = self._asked.get(key)
        if asked is None or asked.outcome is None or len(asked.motions) <= len(asked.refusals):
            return None
        motion = asked.motions[len(asked.refusals)]
        return CompleteStep(motion, asked.outcome, asked.time_ns, self._rewards.get(key))

    def remove_step(self, key: StepKey) -> None:
        """Forget a step, as it is in its timeline now."""
        del self._asked[key]
        self._rewards.pop(key, None)

    def keep_episodes(self, episodes: Collection[EpisodeKey]) -> None:
        """Forget the steps of all other episodes, but not those of the episode that each simulator began last."""
        kept = {*episodes, *{sim: (sim, number) for sim, number, _ in self._asked}.values()}
        self._asked = {key: asked for key, asked in self._asked.items() if key[:2] in kept}
        self._rewards = {key: value for key, value in self._rewards.items() if key[:2] in kept}


class PlanAssembler:
    """Matches the planner's answers with the requests that they belong to."""

    def __init__(self) -> None:
        self._requests: dict[tuple[str, int], PlanRequest] = {}
        self._results: dict[tuple[str, int], list[tuple[int, PlanResult]]] = {}

    def add_request(self, request: PlanRequest) -> Sequence[tuple[int, PlanResult]]:
        """Add a request; returns the answers to it that came before, each with its time."""
        key = (request.header.incarnation, request.request_id)
        self._requests[key] = request
        return self._results.pop(key, [])

    def add_result(self, result: PlanResult, time_ns: int) -> PlanRequest | None:
        """Add an answer; returns its request, or None if that has not come yet."""
        key = (result.client_incarnation, result.request_id)
        request = self._requests.get(key)
        if request is None:
            self._results.setdefault(key, []).append((time_ns, result))
        return request

    def clear(self) -> None:
        """Forget all requests, and the answers that wait for one."""
        self._requests.clear()
        self._results.clear()
