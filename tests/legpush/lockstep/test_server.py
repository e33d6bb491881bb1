"""The simulator's end of the lockstep, without a network: what is carried out, repeated, and refused."""

from itertools import count
from math import inf, nan
from typing import Any

import mujoco
import pytest
from hypothesis import given
from hypothesis import strategies as st
from msgspec.structs import replace

from legpush.bounds import MAX_COUNT
from legpush.errors import LegpushError, MessageError, ScenarioError
from legpush.lockstep.server import Denial, StepGuard, Unheard
from legpush.messages.stepping import Action, Motion, Outcome, Push, Walk
from tests.legpush.examples import RESET, WORLD, header
from tests.legpush.fakes import FakeStepper, crc_after, mission

MISSION = mission(6)
SEQUENCE = count()


def action(
    step: int,
    motion: Motion | None = None,
    episode: int = 1,
    *,
    incarnation: str = "a",
    name: str = "main",
    sequence: int | None = None,
    **fields: Any,
) -> Action:
    """An action as an agent sends it: each has a sequence of its own."""
    number = next(SEQUENCE) if sequence is None else sequence
    sender = replace(header("agent"), name=name, incarnation=incarnation, sequence=number)
    return Action(header=sender, episode=episode, step=step, motion=motion or MISSION[step], **fields)


class Agents:
    """Who is alive."""

    def __init__(self) -> None:
        self.live = {("main", "a"), ("main", "b"), ("other", "c")}

    def __call__(self, name: str, incarnation: str) -> bool:
        return (name, incarnation) in self.live


@pytest.fixture
def agents() -> Agents:
    """Three agents are alive."""
    return Agents()


@pytest.fixture
def stepper() -> FakeStepper:
    """A simulator without physics."""
    return FakeStepper()


@pytest.fixture
def guard(stepper: FakeStepper, agents: Agents) -> StepGuard:
    """A guard that has done steps 0 to 2 of episode 1 for agent a."""
    guard = StepGuard(stepper, agents)
    for step in range(3):
        assert isinstance(guard.answer(action(step)), Outcome)
    return guard


def test_the_next_step_is_carried_out(guard: StepGuard, stepper: FakeStepper) -> None:
    outcome = guard.answer(action(3))
    assert isinstance(outcome, Outcome)
    assert outcome.state_crc == crc_after(MISSION[:4])
    assert stepper.performed == MISSION[:4]


def test_the_step_just_done_is_repeated_and_not_done_again(guard: StepGuard, stepper: FakeStepper) -> None:
    first, second = guard.answer(action(3)), guard.answer(action(3))
    assert first == second
    assert stepper.performed == MISSION[:4]


@pytest.mark.parametrize(
    "other", [action(2, Push(w1=0.1, w2=0.2, leg="FL", depth_m=0.1)), action(2, with_trace=True)], ids=["push", "trace"]
)
def test_another_action_for_a_step_that_is_done_is_a_conflict(
    guard: StepGuard, stepper: FakeStepper, other: Action
) -> None:
    denial = guard.answer(other)
    assert isinstance(denial, Denial)
    assert denial.cause == "conflict"
    assert stepper.performed == MISSION[:3]


@pytest.mark.parametrize(("episode", "step"), [(1, 1), (1, 4), (1, 100), (0, 3), (0, 0), (2, 3), (2, 1)])
def test_a_step_that_is_not_next_is_refused_with_the_one_that_is(
    guard: StepGuard, stepper: FakeStepper, episode: int, step: int
) -> None:
    denial = guard.answer(action(step, RESET if step == 0 else Walk(), episode))
    assert isinstance(denial, Denial)
    assert denial[0] == "out_of_step"
    assert (denial.next_episode, denial.next_step) == (1, 3)
    assert stepper.performed == MISSION[:3]


@pytest.mark.parametrize("episode", [2, 1_700_000_000_000])
def test_a_reset_opens_any_newer_episode(guard: StepGuard, stepper: FakeStepper, episode: int) -> None:
    assert isinstance(guard.answer(action(0, episode=episode)), Outcome)
    assert isinstance(guard.answer(action(1, episode=episode)), Outcome)
    assert stepper.performed == [*MISSION[:3], *MISSION[:2]]


def test_a_fresh_simulator_takes_a_reset_of_any_episode_and_nothing_else(stepper: FakeStepper) -> None:
    guard = StepGuard(stepper, Agents())
    denial = guard.answer(action(3))
    assert isinstance(denial, Denial)
    assert (denial.cause, denial.next_episode, denial.next_step) == ("out_of_step", 0, 0)
    assert isinstance(guard.answer(action(0, episode=77)), Outcome)


def test_an_episode_that_does_not_begin_with_a_reset_is_invalid(stepper: FakeStepper) -> None:
    denial = StepGuard(stepper, Agents()).answer(action(0, Walk()))
    assert isinstance(denial, Denial)
    assert denial.cause == "invalid"
    assert "expected a reset as step 0" in denial.reason


def test_a_reset_within_an_episode_is_invalid(guard: StepGuard, stepper: FakeStepper) -> None:
    denial = guard.answer(action(3, RESET))
    assert isinstance(denial, Denial)
    assert denial.cause == "invalid"
    assert stepper.performed == MISSION[:3]


def test_after_a_motion_that_cannot_be_carried_out_the_same_step_is_still_next(stepper: FakeStepper) -> None:
    guard = StepGuard(stepper, Agents())
    guard.answer(action(0))
    denial = guard.answer(action(1, Walk()))
    assert isinstance(denial, Denial)
    assert denial.cause == "invalid"
    assert "Expected a follow before the first walk" in denial.reason
    assert (denial.next_episode, denial.next_step) == (1, 1)
    assert isinstance(guard.answer(action(1)), Outcome)


class FailingStepper(FakeStepper):
    """Fails at the next motion with one error, or with an outcome that no message can hold."""

    def __init__(self) -> None:
        super().__init__()
        self.fails: Exception | Outcome | None = None

    def perform(self, motion: Motion, *, with_trace: bool) -> Outcome:
        fails, self.fails = self.fails, None
        if isinstance(fails, Exception):
            raise fails
        return fails or super().perform(motion, with_trace=with_trace)


def unspeakable(value: float) -> Outcome:
    """An outcome with a number that is not finite."""
    box = replace(WORLD.box, position_m=(0.0, value, 0.0))
    return Outcome(world=replace(WORLD, box=box), state_crc=1)


FAILURES = (
    LegpushError("qpos is not finite at tick 7"),
    MessageError("Expected a finite number"),
    OverflowError("math range error"),
    ValueError("size 0 in geom"),
    MemoryError(),
    ZeroDivisionError("float division by zero"),
    RecursionError("maximum recursion depth exceeded"),
    mujoco.FatalError("arena is too small"),
    KeyError("box"),
    unspeakable(nan),
    unspeakable(inf),
    unspeakable(-inf),
    Outcome(world=WORLD, state_crc=2**70),
)


def test_a_scenario_that_cannot_be_built_is_invalid_and_breaks_nothing() -> None:
    stepper = FailingStepper()
    guard = StepGuard(stepper, Agents())
    guard.answer(action(0))
    stepper.fails = ScenarioError("box outside")
    denial = guard.answer(action(0, episode=2))
    assert isinstance(denial, Denial)
    assert (denial.cause, denial.next_episode, denial.next_step) == ("invalid", 1, 1)
    assert isinstance(guard.answer(action(1)), Outcome)


@pytest.mark.parametrize("at", [0, 1, 3])
@pytest.mark.parametrize("failure", FAILURES, ids=repr)
def test_after_a_failure_of_the_simulator_only_a_newer_episode_goes_on(failure: Exception | Outcome, at: int) -> None:
    stepper = FailingStepper()
    guard = StepGuard(stepper, Agents())
    for step in range(at):
        assert isinstance(guard.answer(action(step)), Outcome)
    stepper.fails = failure
    for step, words in ((at, ""), (at, f"broken since step {at}: "), (at + 1, f"broken since step {at}: ")):
        denial = guard.answer(action(step))
        assert isinstance(denial, Denial)
        assert denial.cause == "invalid"
        assert denial.reason.startswith(f"{words}The simulator failed in a ")
        assert (denial.next_episode, denial.next_step) == (2, 0)
    assert stepper.performed == MISSION[:at]
    late = guard.answer(action(1, episode=2))
    assert isinstance(late, Denial)
    assert late.cause == "out_of_step"
    assert isinstance(guard.answer(action(0, episode=2)), Outcome)
    assert isinstance(guard.answer(action(1, episode=2)), Outcome)


def test_the_last_episode_can_break_too() -> None:
    stepper = FailingStepper()
    guard = StepGuard(stepper, Agents())
    stepper.fails = ValueError("no")
    denial = guard.answer(action(0, episode=MAX_COUNT))
    assert isinstance(denial, Denial)
    assert denial.next_episode == MAX_COUNT


@pytest.mark.parametrize(("name", "incarnation"), [("main", "b"), ("other", "c")])
@pytest.mark.parametrize("episode", [1, 2, MAX_COUNT])
def test_another_agent_is_refused_while_the_first_is_alive(
    guard: StepGuard, stepper: FakeStepper, name: str, incarnation: str, episode: int
) -> None:
    for step in (0, 2, 3):
        denial = guard.answer(action(step, episode=episode, name=name, incarnation=incarnation))
        assert isinstance(denial, Denial)
        assert denial.cause == "conflict"
        assert "it works for agent main (a), which is alive" in denial.reason
    assert stepper.performed == MISSION[:3]
    assert isinstance(guard.answer(action(3)), Outcome)


@pytest.mark.parametrize("step", [2, 3])
def test_a_restarted_agent_goes_on_at_the_last_step_or_the_next(
    guard: StepGuard, agents: Agents, stepper: FakeStepper, step: int
) -> None:
    agents.live.remove(("main", "a"))
    assert isinstance(guard.answer(action(step, incarnation="b", sequence=0)), Outcome)
    agents.live.add(("main", "a"))
    denial = guard.answer(action(step + 1))
    assert isinstance(denial, Denial)
    assert denial.cause == "conflict"
    assert isinstance(guard.answer(action(step + 1, incarnation="b", sequence=1)), Outcome)
    assert stepper.performed == MISSION[: step + 2]


@pytest.mark.parametrize(("name", "incarnation"), [("main", "stale"), ("other", "a"), ("main", "c")])
@pytest.mark.parametrize("step", [0, 2, 3])
def test_an_agent_without_a_token_is_not_answered(
    guard: StepGuard, stepper: FakeStepper, name: str, incarnation: str, step: int
) -> None:
    unheard = guard.answer(action(step, episode=1 + (step == 0), name=name, incarnation=incarnation))
    assert isinstance(unheard, Unheard)
    assert unheard.cause == "no_token"
    assert stepper.performed == MISSION[:3]


def test_the_owner_without_a_token_is_not_answered_until_it_is_back(guard: StepGuard, agents: Agents) -> None:
    agents.live.clear()
    assert isinstance(guard.answer(action(3)), Unheard)
    agents.live.add(("main", "a"))
    assert isinstance(guard.answer(action(3)), Outcome)


def test_a_next_step_with_an_old_sequence_is_not_of_the_agent_and_not_answered(
    guard: StepGuard, stepper: FakeStepper
) -> None:
    sequence = next(SEQUENCE)
    assert isinstance(guard.answer(action(3, sequence=sequence)), Outcome)
    for old in (sequence, sequence - 1, 0):
        unheard = guard.answer(action(4, sequence=old))
        assert isinstance(unheard, Unheard)
        assert unheard.cause == "repeated"
    assert stepper.performed == MISSION[:4]
    assert isinstance(guard.answer(action(4)), Outcome)


def test_a_copy_that_was_overtaken_is_answered_and_does_not_bring_an_old_sequence_back(guard: StepGuard) -> None:
    early, late = next(SEQUENCE), next(SEQUENCE)
    assert isinstance(guard.answer(action(3, sequence=late)), Outcome)
    assert isinstance(guard.answer(action(3, sequence=early)), Outcome)
    assert isinstance(guard.answer(action(4, sequence=late)), Unheard)


@given(st.lists(st.integers(0, len(MISSION) - 1), max_size=60))
def test_whatever_order_actions_come_in_no_step_is_done_twice_or_left_out(steps: list[int]) -> None:
    stepper = FakeStepper()
    guard = StepGuard(stepper, Agents())
    for step in steps:
        guard.answer(action(step))
    assert stepper.performed == MISSION[: len(stepper.performed)]
