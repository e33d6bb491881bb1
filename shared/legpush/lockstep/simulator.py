"""A simulator as a function: the seam at which another simulator is plugged in."""

from typing import Protocol

from legpush.messages.stepping import Motion, Outcome


class Stepper(Protocol):
    """A simulator whose only input are the motions, in order."""

    def perform(self, motion: Motion, *, with_trace: bool) -> Outcome:
        """Carry out one motion; the outcome has a trace of every tick if `with_trace`.

        Raises:
            MotionError: The motion cannot be carried out; the state is as it was.
        """
