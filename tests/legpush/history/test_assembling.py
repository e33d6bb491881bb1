"""Steps and plans are complete when their messages have come, in any order, and are forgotten when asked for."""

from collections.abc import Callable
from itertools import permutations

import pytest
from msgspec.structs import replace

from legpush.history.assembling import PlanAssembler, StepAssembler, StepKey
from legpush.messages.planning import PlanRequest, PlanResult
from legpush.messages.stepping import Motion, Observation, Outcome, Push, Refusal, Walk
from tests.legpush.examples import MESSAGES, TRACE, WORLD

KEY: StepKey = ("main", 7, 3)
PUSHES: list[Motion] = [Push(w1=0.1, w2=w2, leg="FL", depth_m=0.1) for w2 in (0.2, 0.3, 0.4)]
DONE = Outcome(world=WORLD, state_crc=1)


def observed(outcome: Outcome) -> Observation:
    message = MESSAGES["observation"]
    assert isinstance(message, Observation)
    return replace(message, outcome=outcome)


def refused(reason: str, cause: str = "invalid") -> Refusal:
    message = MESSAGES["refusal"]
    assert isinstance(message, Refusal)
    return replace(message, reason=reason, cause=cause)


@pytest.mark.parametrize("order", list(permutations(range(3))))
def test_a_step_is_complete_with_motion_and_outcome_and_has_its_reward(order: tuple[int, ...]) -> None:
    steps = StepAssembler()
    parts: list[Callable[[], object]] = [
        lambda: steps.add_motion(KEY, Walk()),
        lambda: steps.add_answer(KEY, observed(DONE), 5),
        lambda: steps.add_reward(KEY, 0.5),
    ]
    for part in order:
        parts[part]()
    assert steps.complete(KEY) == (Walk(), DONE, 5, 0.5)
    assert steps.complete(("main", 7, 4)) is None


@pytest.mark.parametrize("lacking", ["motion", "answer"])
def test_a_step_that_lacks_something_is_not_complete(lacking: str) -> None:
    steps = StepAssembler()
    if lacking != "motion":
        steps.add_motion(KEY, Walk())
    if lacking != "answer":
        steps.add_answer(KEY, observed(DONE), 5)
    assert steps.complete(KEY) is None


def test_the_motion_that_was_carried_out_is_the_one_after_those_that_were_refused() -> None:
    steps = StepAssembler()
    steps.add_answer(KEY, observed(DONE), 5)
    for reason in ("too deep", "too far", "too far"):
        steps.add_answer(KEY, refused(reason), 4)
    steps.add_answer(KEY, refused("not the next step", "out_of_step"), 4)
    for push in PUSHES[:2]:
        assert steps.add_motion(KEY, push)
    assert steps.complete(KEY) is None
    assert steps.add_motion(KEY, PUSHES[2])
    assert not steps.add_motion(KEY, PUSHES[2]), "it was sent again"
    complete = steps.complete(KEY)
    assert complete is not None
    assert complete.motion == PUSHES[2]


def test_an_outcome_with_its_trace_replaces_one_without() -> None:
    steps, traced = StepAssembler(), replace(DONE, trace=TRACE)
    steps.add_motion(KEY, Walk())
    for outcome, time_ns in ((DONE, 1), (traced, 2), (DONE, 3)):
        steps.add_answer(KEY, observed(outcome), time_ns)
    assert steps.complete(KEY) == (Walk(), traced, 2, None)


def test_a_step_that_is_removed_begins_again_from_nothing() -> None:
    steps = StepAssembler()
    steps.add_motion(KEY, Walk())
    steps.add_answer(KEY, observed(DONE), 5)
    steps.add_reward(KEY, 0.5)
    steps.remove_step(KEY)
    assert steps.complete(KEY) is None
    steps.add_motion(KEY, Walk())
    steps.add_answer(KEY, observed(DONE), 6)
    assert steps.complete(KEY) == (Walk(), DONE, 6, None)


def test_steps_of_old_episodes_are_forgotten_but_not_those_of_the_one_that_each_simulator_began_last() -> None:
    steps = StepAssembler()
    keys = [("a", 1, 0), ("a", 2, 0), ("a", 3, 0), ("b", 1, 0)]
    for key in keys:
        steps.add_motion(key, Walk())
        steps.add_answer(key, observed(DONE), 5)
    steps.keep_episodes([("a", 1)])
    assert [key for key in keys if steps.complete(key)] == [("a", 1, 0), ("a", 3, 0), ("b", 1, 0)]


def request(request_id: int) -> PlanRequest:
    message = MESSAGES["plan_request"]
    assert isinstance(message, PlanRequest)
    return replace(message, request_id=request_id)


def result(request_id: int, revision: int) -> PlanResult:
    message = MESSAGES["plan_result"]
    assert isinstance(message, PlanResult)
    return replace(message, request_id=request_id, revision=revision)


def test_an_answer_finds_its_request_whichever_comes_first() -> None:
    plans = PlanAssembler()
    assert plans.add_result(result(2, 0), 10) is None
    assert plans.add_result(result(3, 0), 11) is None
    assert plans.add_request(request(2)) == [(10, result(2, 0))]
    assert plans.add_request(request(2)) == [], "it was sent again"
    assert plans.add_result(result(2, 1), 12) == request(2)


def test_after_clearing_no_answer_finds_its_request() -> None:
    plans = PlanAssembler()
    plans.add_request(request(2))
    plans.add_result(result(3, 0), 10)
    plans.clear()
    assert plans.add_result(result(2, 0), 11) is None
    assert plans.add_request(request(3)) == []
