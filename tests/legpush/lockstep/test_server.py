"""The simulator's end of the lockstep, without a network: what is carried out, repeated, and refused."""

from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from legpush.errors import LegpushError, ScenarioError
from legpush.lockstep.server import Denial, StepGuard
from legpush.messages.stepping import Action, Motion, Outcome, Push, Walk
from tests.legpush.examples import RESET, header
from tests.legpush.fakes import FakeStepper, crc_after, mission

MISSION = mission(6)


def action(step: int, motion: Motion | None = None, episode: int = 1, **fields: Any) -> Action:
    return Action(header=header("agent"), episode=episode, step=step, motion=motion or MISSION[step], **fields)


@pytest.fixture
def stepper() -> FakeStepper:
    """A simulator without physics."""
    return FakeStepper()


@pytest.fixture
def guard(stepper: FakeStepper) -> StepGuard:
    """A guard that has done steps 0 to 2 of episode 1."""
    guard = StepGuard(stepper)
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
    guard = StepGuard(stepper)
    denial = guard.answer(action(3))
    assert isinstance(denial, Denial)
    assert (denial.cause, denial.next_episode, denial.next_step) == ("out_of_step", 0, 0)
    assert isinstance(guard.answer(action(0, episode=77)), Outcome)


def test_an_episode_that_does_not_begin_with_a_reset_is_invalid(stepper: FakeStepper) -> None:
    denial = StepGuard(stepper).answer(action(0, Walk()))
    assert isinstance(denial, Denial)
    assert denial.cause == "invalid"
    assert "expected a reset as step 0" in denial.reason


def test_a_reset_within_an_episode_is_invalid(guard: StepGuard, stepper: FakeStepper) -> None:
    denial = guard.answer(action(3, RESET))
    assert isinstance(denial, Denial)
    assert denial.cause == "invalid"
    assert stepper.performed == MISSION[:3]


def test_after_a_motion_that_cannot_be_carried_out_the_same_step_is_still_next(stepper: FakeStepper) -> None:
    guard = StepGuard(stepper)
    guard.answer(action(0))
    denial = guard.answer(action(1, Walk()))
    assert isinstance(denial, Denial)
    assert denial.cause == "invalid"
    assert "Expected a follow before the first walk" in denial.reason
    assert (denial.next_episode, denial.next_step) == (1, 1)
    assert isinstance(guard.answer(action(1)), Outcome)


class BrokenStepper:
    """Fails at everything with one error."""

    def __init__(self, error: LegpushError) -> None:
        self._error = error

    def perform(self, motion: Motion, *, with_trace: bool) -> Outcome:
        raise self._error


def test_a_scenario_that_cannot_be_built_is_invalid_and_ends_nothing() -> None:
    denial = StepGuard(BrokenStepper(ScenarioError("box outside"))).answer(action(0))
    assert isinstance(denial, Denial)
    assert denial.cause == "invalid"


def test_broken_physics_ends_the_simulator() -> None:
    with pytest.raises(LegpushError, match="not finite at tick 7"):
        StepGuard(BrokenStepper(LegpushError("qpos is not finite at tick 7"))).answer(action(0))


@given(st.lists(st.integers(0, len(MISSION) - 1), max_size=60))
def test_whatever_order_actions_come_in_no_step_is_done_twice_or_left_out(steps: list[int]) -> None:
    stepper = FakeStepper()
    guard = StepGuard(stepper)
    for step in steps:
        guard.answer(action(step))
    assert stepper.performed == MISSION[: len(stepper.performed)]
