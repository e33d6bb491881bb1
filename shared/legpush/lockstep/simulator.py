"""A simulator as a function: the seam at which another simulator is plugged in."""

from typing import Protocol, runtime_checkable

from legpush.messages.stepping import Motion, Outcome
from legpush.scene.scenario import Scenario


class Stepper(Protocol):
    """A simulator whose only input are the motions, in order."""

    def perform(self, motion: Motion, *, with_trace: bool) -> Outcome:
        """Carry out one motion; the outcome has a trace of every tick if `with_trace`.

        Raises:
            MotionError: The motion cannot be carried out; the state is as it was.
        """


@runtime_checkable
class LimitedStepper(Stepper, Protocol):
    """A simulator that does not know every scenario; commands ask it before they write anything."""

    def require_described(self, scenario: Scenario) -> None:
        """Require a scenario that it knows.

        Raises:
            ScenarioError: It is another one; says what it knows.
        """
