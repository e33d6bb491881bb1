"""A world on the bus: a simulator that may die, and be replaced, at any time."""

from collections.abc import Mapping

from legpush.lockstep.client import PastStep, SimLink
from legpush.messages.stepping import Motion, Outcome, Reset


class BusWorld:
    """A simulator on the bus, which may die at any time: the one that takes its place is led to the same state.

    An episode is never truncated for that. Its past motions are all that it takes to do it again, bit for bit, so what
    a learner sees does not depend on whether a simulator died. In the same way two worlds may share a link, one at a
    time: when one steps after the other, its episode is done again first.
    """

    def __init__(self, link: SimLink) -> None:
        self._link = link
        self._past: list[PastStep] = []
        self._episode = -1

    @property
    def name(self) -> str:
        """Name of the simulator."""
        return self._link.sim

    def beside(self) -> "BusWorld":
        """Another world of the same simulator."""
        return BusWorld(self._link)

    def step(self, motion: Motion, *, with_trace: bool = False) -> Outcome:
        """Carry out one motion.

        Raises:
            MotionError: The motion cannot be carried out; the state is as it was.
            PeerError: No simulator of this name answers in time.
        """
        if isinstance(motion, Reset):
            self._past = []
        if isinstance(motion, Reset) or self._link.episode != self._episode:
            self._link.begin()
        outcome = self._link.step(motion, self._past, with_trace=with_trace)
        self._episode = self._link.episode
        self._past.append(PastStep(motion, outcome.state_crc))
        return outcome

    def tell_reward(self, terms: Mapping[str, float]) -> None:
        """Publish what the last step earned, unless another world uses the link meanwhile."""
        if self._link.episode == self._episode:
            self._link.tell_reward(len(self._past) - 1, terms)
