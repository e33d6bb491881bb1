"""The world of a mission that is really run: an episode in lockstep, told to whoever watches."""

import logging
import threading
from collections.abc import Mapping

from agent_proc.mission.branching import Branch
from legpush.bus.bus import Bus
from legpush.bus.status import StatusBeacon
from legpush.history.journal import Journal
from legpush.lockstep.client import SimLink
from legpush.lockstep.episode import Episode
from legpush.messages.planning import Plan, PlanQuery
from legpush.messages.stepping import Motion, Outcome
from legpush.patience import Patience
from legpush.plans.client import PlanLink

log = logging.getLogger(__name__)


class LiveWorld:
    """Steps and plans through the bus, or from the journal as long as that has answers."""

    def __init__(
        self,
        bus: Bus,
        journal: Journal,
        beacon: StatusBeacon,
        *,
        sim: str,
        patience: Patience,
        stop: threading.Event,
        branch: Branch | None = None,
    ) -> None:
        """Connect to the simulator named `sim` and to the planner; neither has to be there yet."""
        self._branch = branch
        self._beacon = beacon
        self._told: tuple[str, float | None, str] = ("starting", None, "")
        self._episode = Episode(
            journal,
            SimLink(bus, sim, stop=stop, patience=patience, on_wait=self._wait),
            PlanLink(bus, stop=stop, patience=patience, on_wait=self._wait),
            None if branch is None else branch.past,
        )

    @property
    def is_live(self) -> bool:
        """Whether anything was asked that the journal did not answer."""
        return self._episode.live

    @property
    def n_steps(self) -> int:
        """How many steps were carried out."""
        return self._episode.n_steps

    def step(self, motion: Motion) -> Outcome:
        """Carry out one motion; its trace goes to the journal."""
        if self._branch is not None and self._branch.alter is not None and self._branch.alters(self.n_steps):
            self._episode.step(self._branch.alter, with_trace=True)
        return self._episode.step(motion, with_trace=True)

    def plan(self, query: PlanQuery) -> Plan:
        """Ask the planner."""
        return self._episode.plan(query)

    def revision(self, revision: int) -> Plan:
        """Wait for a better plan."""
        return self._episode.revision(revision)

    def cancel_plan(self) -> None:
        """Wait for no more of them."""
        self._episode.cancel_plan()

    def tell(self, phase: str, fraction: float | None, detail: str) -> None:
        """Publish what goes on, and log what each phase begins with."""
        if phase != self._told[0]:
            log.info("%s: %s", phase, detail)
        self._told = (phase, fraction, detail)
        self._beacon.say(phase, fraction, detail)

    def tell_reward(self, terms: Mapping[str, float]) -> None:
        """Publish what the last step earned."""
        self._episode.tell_reward(terms)

    def _wait(self, text: str) -> None:
        """Publish whom the mission waits for, with what it was doing; empty when it goes on."""
        phase, fraction, detail = self._told
        self._beacon.say(phase, fraction, detail, waiting_for=text)
