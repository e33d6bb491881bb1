"""The history of a run: the timelines of its episodes, its plans, and the statuses of its processes.

Messages may come in any order that keeps each sender's own, live or from a recording; the result is the same.
"""

from collections.abc import Iterator
from dataclasses import dataclass

from legpush.errors import MessageError
from legpush.history.assembling import EpisodeKey, PlanAssembler, StepAssembler, StepKey
from legpush.history.timeline import Timeline, is_whole
from legpush.messages import codec
from legpush.messages.planning import Plan, PlanQuery, PlanRequest, PlanResult
from legpush.messages.stepping import Action, Answer, Motion, Observation, Refusal, Reset
from legpush.messages.telemetry import Copy, Origin, Reward, Status
from legpush.scene.scenario import Scenario


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


class RunHistory:
    """The episodes of a run, its plans and statuses; grows with every message that is taken."""

    def __init__(self) -> None:
        self.episodes: dict[EpisodeKey, Timeline] = {}
        """By simulator and number on the wire, in the order in which they began."""
        self.indices: dict[EpisodeKey, int] = {}
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
        self._steps = StepAssembler()
        self._plans = PlanAssembler()

    def take_message(self, topic: str, origin: Origin, copy: Copy) -> None:
        """Take in a message that was published under a topic such as `sim/main/action`."""
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

    def keep_newest(self, n_episodes: int) -> None:
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
        self._steps.keep_episodes(self.episodes)
        self._plans.clear()

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

    def _later(self, timeline: Timeline) -> Iterator[tuple[EpisodeKey, Timeline]]:
        """The episodes of the same simulator that began after it."""
        began = timeline.steps[0].time_ns
        sim = next((sim for (sim, _), each in self.episodes.items() if each is timeline), None)
        for key, each in self.episodes.items():
            if key[0] == sim and each.steps[0].time_ns > began:
                yield key, each

    def _held_keys(self) -> Iterator[EpisodeKey]:
        """Of the episode that is held, and of the one after it, which tells when it ended."""
        if self.held is not None:
            yield from (key for key, each in self.episodes.items() if each is self.held)
            following = min(self._later(self.held), key=lambda each: each[1].steps[0].time_ns, default=None)
            if following is not None:
                yield following[0]

    def _take_action(self, sim: str, action: Action) -> None:
        key = (sim, action.episode, action.step)
        if not self._is_done(key) and self._steps.add_motion(key, action.motion):
            self._advance(key)

    def _take_answer(self, sim: str, answer: Answer, time_ns: int) -> None:
        if isinstance(answer, Observation) and answer.outcome.trace is not None and not is_whole(answer.outcome.trace):
            raise MessageError(f"Expected a trace with a row for each tick of step {answer.step}")
        key = (sim, answer.episode, answer.step)
        if not self._is_done(key):
            self._steps.add_answer(key, answer, time_ns)
            self._advance(key)

    def _is_done(self, key: StepKey) -> bool:
        """Whether a step is in its timeline, or lies before the first one that is known."""
        timeline = self.episodes.get(key[:2])
        return timeline is not None and key[2] <= timeline.steps[-1].number

    def _advance(self, key: StepKey) -> None:
        """Add the steps that are complete now to their timeline, in order, from this one on."""
        sim, episode, step = key
        while (done := self._steps.complete((sim, episode, step))) is not None:
            timeline = self.episodes.get((sim, episode))
            if timeline is None:
                timeline = self._begin((sim, episode), done.motion)
            elif step != timeline.steps[-1].number + 1:
                return
            if timeline is None:
                return
            self._steps.remove_step((sim, episode, step))
            timeline.add(step, done.motion, done.outcome, done.time_ns)
            if done.reward is not None:
                timeline.rewards[step] = done.reward
            step += 1

    def _begin(self, key: EpisodeKey, motion: Motion) -> Timeline | None:
        """A timeline for a new episode, of which this is the first known motion; None if its scenario is not known."""
        scenario = motion.scenario if isinstance(motion, Reset) else self.scenario
        if scenario is None:
            return None
        self.indices[key] = max(self.indices.values(), default=-1) + 1  # `keep_newest` keeps the newest one.
        self.episodes[key] = Timeline(scenario)
        return self.episodes[key]

    def _take_reward(self, reward: Reward) -> None:
        key = (reward.sim, reward.episode, reward.step)
        if self._is_done(key):
            self.episodes[key[:2]].rewards[reward.step] = reward.value
        else:
            self._steps.add_reward(key, reward.value)

    def _take_request(self, request: PlanRequest) -> None:
        for time_ns, result in self._plans.add_request(request):
            self._add_plan(request, result, time_ns)

    def _take_result(self, result: PlanResult, time_ns: int) -> None:
        request = self._plans.add_result(result, time_ns)
        if request is not None:
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
