"""From messages to what can be looked at: episodes of all simulators, plans, and what processes said of themselves.

Messages may come in any order that keeps each sender's own, live or from a recording; the result is the same.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field

from legpush.errors import MessageError
from legpush.history.timeline import Timeline, is_whole
from legpush.messages import codec
from legpush.messages.planning import Plan, PlanQuery, PlanRequest, PlanResult
from legpush.messages.stepping import Action, Answer, Motion, Observation, Outcome, Refusal, Reset
from legpush.messages.telemetry import Copy, Origin, Reward, Status
from legpush.scene.scenario import Scenario

Step = tuple[str, int, int]
"""Simulator, episode on the wire, step."""


@dataclass(frozen=True, kw_only=True)
class PlanAt:
    """An answer of the planner."""

    time_ns: int
    client: str
    query: PlanQuery
    revision: int
    plan: Plan


@dataclass(frozen=True, kw_only=True)
class Said:
    """What a process said it was doing."""

    time_ns: int
    origin: Origin
    status: Status


@dataclass(kw_only=True)
class _Asked:
    """What is known of a step that is not complete."""

    motions: list[Motion] = field(default_factory=list)
    """That were asked for, one after the other: each but the last has to have been refused."""
    refusals: set[str] = field(default_factory=set)
    """Their reasons: an action that was sent again is refused again."""
    outcome: Outcome | None = None
    time_ns: int = 0


class Timelines:
    """Grows with every message that is taken."""

    def __init__(self) -> None:
        self.episodes: dict[tuple[str, int], Timeline] = {}
        """By simulator and number on the wire, in the order in which they began."""
        self.indices: dict[tuple[str, int], int] = {}
        """Of the same episodes, counted from the first one that began."""
        self.held: Timeline | None = None
        """Is kept however old it is."""
        self.plans: list[PlanAt] = []
        """In the order in which they became known."""
        self.said: list[Said] = []
        self.scenario: Scenario | None = None
        """Of episodes whose reset was before the first message that is known."""
        self.n_unreadable = 0
        """Messages that are none of this protocol."""
        self._n_begun = 0
        self._asked: dict[Step, _Asked] = {}
        self._requests: dict[tuple[str, int], PlanRequest] = {}
        self._results: dict[tuple[str, int], list[tuple[int, PlanResult]]] = {}
        self._rewards: dict[Step, float] = {}

    def take(self, topic: str, origin: Origin, copy: Copy) -> None:
        """A message that was published under a topic such as `sim/main/action`."""
        place, _, what = topic.rpartition("/")
        name = place.rpartition("/")[2]
        try:
            match what:
                case "action":
                    self._take_action(name, codec.decode(copy.payload, Action))
                case "observation":
                    answer: Answer = codec.decode(copy.payload, Observation | Refusal)  # type: ignore[arg-type]
                    self._take_answer(name, answer, copy.time_ns)
                case "reward":
                    self._take_reward(codec.decode(copy.payload, Reward))
                case "request":
                    self._take_request(codec.decode(copy.payload, PlanRequest))
                case "result":
                    self._take_result(codec.decode(copy.payload, PlanResult), copy.time_ns)
                case "status":
                    status = codec.decode(copy.payload, Status)
                    self.said.append(Said(time_ns=copy.time_ns, origin=origin, status=status))
                case _:
                    pass
        except MessageError:
            self.n_unreadable += 1

    def keep(self, n_episodes: int) -> None:
        """Forget all but the newest episodes and the one that is held, and what was said and planned at other times."""
        keys = list(self.episodes)
        newest, held = keys[-n_episodes:], list(self._held_keys())
        kept = {*newest, *held}
        forgotten = [key for key in keys if key not in kept]
        if not forgotten:
            return
        for key in forgotten:
            del self.episodes[key], self.indices[key]
        newest_ns = min(self.episodes[key].steps[0].time_ns for key in newest)
        began_ns, ended_ns = self.span_ns(self.episodes[held[0]]) if held else (newest_ns, newest_ns)
        self.plans = [p for p in self.plans if p.time_ns >= newest_ns or began_ns <= p.time_ns <= ended_ns]
        self.said = [s for s in self.said if s.time_ns >= newest_ns or began_ns <= s.time_ns <= ended_ns]
        going_on = {*self.episodes, *{sim: (sim, number) for sim, number, _ in self._asked}.values()}
        self._asked = {place: asked for place, asked in self._asked.items() if place[:2] in going_on}
        self._rewards = {place: value for place, value in self._rewards.items() if place[:2] in going_on}
        self._requests.clear()
        self._results.clear()

    def plans_of(self, timeline: Timeline) -> Iterator[tuple[int, PlanAt]]:
        """The plans that were made during an episode, each with the row at which it was there."""
        if not timeline.steps:
            return
        began, ended = self.span_ns(timeline)
        for planned in self.plans:
            if began <= planned.time_ns <= ended:
                yield timeline.row_at(planned.time_ns), planned

    def span_ns(self, timeline: Timeline) -> tuple[int, int]:
        """From when to when an episode lasted, since 1970: up to where the next one of its simulator begins."""
        began = timeline.steps[0].time_ns
        return began, min((each.steps[0].time_ns for _, each in self._later(timeline)), default=2**63)

    def _later(self, timeline: Timeline) -> Iterator[tuple[tuple[str, int], Timeline]]:
        """The episodes of the same simulator that began after it."""
        began = timeline.steps[0].time_ns
        sim = next((sim for (sim, _), each in self.episodes.items() if each is timeline), None)
        for key, each in self.episodes.items():
            if key[0] == sim and each.steps[0].time_ns > began:
                yield key, each

    def _held_keys(self) -> Iterator[tuple[str, int]]:
        """Of the episode that is held, and of the one after it, which tells when it ended."""
        if self.held is not None:
            yield from (key for key, each in self.episodes.items() if each is self.held)
            following = min(self._later(self.held), key=lambda each: each[1].steps[0].time_ns, default=None)
            if following is not None:
                yield following[0]

    def _take_action(self, sim: str, action: Action) -> None:
        asked = self._open((sim, action.episode, action.step))
        if asked is not None and action.motion not in asked.motions:
            asked.motions.append(action.motion)
            self._advance((sim, action.episode, action.step))

    def _take_answer(self, sim: str, answer: Answer, time_ns: int) -> None:
        if isinstance(answer, Observation) and answer.outcome.trace is not None and not is_whole(answer.outcome.trace):
            raise MessageError(f"Expected a trace with a row for each tick of step {answer.step}")
        asked = self._open((sim, answer.episode, answer.step))
        if asked is None:
            return
        if isinstance(answer, Refusal):
            if answer.cause == "invalid":
                asked.refusals.add(answer.reason)
        elif asked.outcome is None or asked.outcome.trace is None:
            asked.outcome, asked.time_ns = answer.outcome, time_ns
        self._advance((sim, answer.episode, answer.step))

    def _open(self, place: Step) -> _Asked | None:
        """What is known of a step; None where it is complete, or before the first one that is known."""
        timeline = self.episodes.get(place[:2])
        if timeline is not None and place[2] <= timeline.steps[-1].number:
            return None
        return self._asked.setdefault(place, _Asked())

    def _advance(self, place: Step) -> None:
        """Add the steps that are complete now, in order."""
        sim, episode, step = place
        while (asked := self._asked.get((sim, episode, step))) is not None:
            if asked.outcome is None or len(asked.motions) <= len(asked.refusals):
                return
            motion, timeline = asked.motions[len(asked.refusals)], self.episodes.get((sim, episode))
            if timeline is None:
                scenario = motion.scenario if isinstance(motion, Reset) else self.scenario
                if scenario is None:
                    return
                timeline = self.episodes[sim, episode] = Timeline(scenario)
                self.indices[sim, episode] = self._n_begun
                self._n_begun += 1
            elif step != timeline.steps[-1].number + 1:
                return
            del self._asked[sim, episode, step]
            timeline.add(step, motion, asked.outcome, asked.time_ns)
            reward = self._rewards.pop((sim, episode, step), None)
            if reward is not None:
                timeline.rewards[step] = reward
            step += 1

    def _take_reward(self, reward: Reward) -> None:
        timeline = self.episodes.get((reward.sim, reward.episode))
        if timeline is not None and reward.step <= timeline.steps[-1].number:
            timeline.rewards[reward.step] = reward.value
        else:
            self._rewards[reward.sim, reward.episode, reward.step] = reward.value

    def _take_request(self, request: PlanRequest) -> None:
        key = (request.header.incarnation, request.request_id)
        self._requests[key] = request
        for time_ns, result in self._results.pop(key, ()):
            self._add_plan(request, result, time_ns)

    def _take_result(self, result: PlanResult, time_ns: int) -> None:
        key = (result.client_incarnation, result.request_id)
        request = self._requests.get(key)
        if request is None:
            self._results.setdefault(key, []).append((time_ns, result))
        else:
            self._add_plan(request, result, time_ns)

    def _add_plan(self, request: PlanRequest, result: PlanResult, time_ns: int) -> None:
        self.plans.append(
            PlanAt(
                time_ns=time_ns,
                client=request.header.name,
                query=request.query,
                revision=result.revision,
                plan=result.plan,
            )
        )
