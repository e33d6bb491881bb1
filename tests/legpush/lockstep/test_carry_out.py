"""Carrying out one motion: what is refused, and what is a failure of the simulator."""

from math import nan

import pytest
from msgspec.structs import replace

from legpush.errors import BrokenEpisodeError, LegpushError, MotionError, RecordingError, ScenarioError
from legpush.lockstep.carry_out import carry_out
from legpush.messages.stepping import Motion, Outcome, Walk
from tests.legpush.examples import RESET, WORLD
from tests.legpush.fakes import FakeStepper


class Failing:
    """Raises an error, or returns an outcome."""

    def __init__(self, result: Exception | Outcome) -> None:
        self._result = result

    def perform(self, motion: Motion, *, with_trace: bool) -> Outcome:
        if isinstance(self._result, Exception):
            raise self._result
        return self._result


def test_a_motion_is_carried_out_as_the_simulator_does() -> None:
    stepper = FakeStepper()
    assert carry_out(stepper, RESET, with_trace=True).trace is not None
    assert stepper.performed == [RESET]


@pytest.mark.parametrize("error", [MotionError("no"), ScenarioError("no"), RecordingError("no")], ids=repr)
def test_a_refusal_stays_what_it_is(error: Exception) -> None:
    with pytest.raises(type(error), match="no"):
        carry_out(Failing(error), RESET, with_trace=False)


@pytest.mark.parametrize(
    ("error", "words"),
    [
        (OverflowError("range"), "The simulator failed in a walk: OverflowError: range"),
        (MemoryError(), "The simulator failed in a walk: MemoryError: "),
        (LegpushError("qpos is not finite"), "The simulator failed in a walk: qpos is not finite"),
    ],
    ids=repr,
)
def test_another_exception_breaks_the_episode(error: Exception, words: str) -> None:
    with pytest.raises(BrokenEpisodeError) as broken:
        carry_out(Failing(error), Walk(), with_trace=False)
    assert str(broken.value) == words
    assert broken.value.__cause__ is error


def test_an_outcome_that_no_message_can_hold_breaks_the_episode() -> None:
    box = replace(WORLD.box, position_m=(0.0, nan, 0.0))
    with pytest.raises(BrokenEpisodeError, match=r"Expected a finite number, got nan - at `\$.world.box.position_m"):
        carry_out(Failing(Outcome(world=replace(WORLD, box=box), state_crc=1)), Walk(), with_trace=False)
