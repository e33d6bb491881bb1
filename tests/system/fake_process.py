"""A fake simulator, planner or agent as a real process: `python fake_process.py sim ...`, with the flags of a real one.

`--die-at N` kills it with SIGKILL in its N-th motion or plan, counted from 0: simulator and planner in the middle of
it; the agent when it has asked (`--die-when asked`) or got the answer (`answered`) and written nothing about it yet.
With `--fail-at N` the simulator raises an exception in its N-th motion.
"""

import os
import signal
import sys
import threading
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from legpush.bus.bus import Bus
from legpush.history.journal import Journal
from legpush.lockstep.client import PastStep, SimLink
from legpush.lockstep.episode import Episode
from legpush.lockstep.server import serve_actions
from legpush.messages.planning import Plan, PlanQuery
from legpush.messages.stepping import Motion, Outcome
from legpush.plans.client import PlanLink
from legpush.plans.server import serve_plans
from legpush.service import ServiceConfig, run_process
from tests.legpush.examples import QUERY
from tests.legpush.fakes import FakeStepper, fake_plan, mission, one_plan, opened


@dataclass(frozen=True, kw_only=True)
class FakeConfig(ServiceConfig):
    """As a real process, and how it is to fail."""

    die_at: int = -1
    """Count of the motion or plan in which it dies."""
    die_when: Literal["asked", "answered"] = "asked"
    """Of that motion or plan."""
    journal: Path = Path("episode-0000.journal")
    """The agent's."""
    fail_at: int = -1
    """Count of the motion in which the simulator raises an exception."""


class Death:
    """Counts motions and plans, and kills this process in the right one."""

    def __init__(self, config: FakeConfig) -> None:
        self._config = config
        self._n_asked = 0

    def asked(self) -> None:
        self._n_asked += 1
        self._strike("asked")

    def answered(self) -> None:
        self._strike("answered")

    def _strike(self, when: str) -> None:
        if self._n_asked - 1 == self._config.die_at and when == self._config.die_when:
            os.kill(os.getpid(), signal.SIGKILL)


class MortalStepper(FakeStepper):
    """A simulator that dies in time, or fails."""

    def __init__(self, config: FakeConfig) -> None:
        super().__init__()
        self._death = Death(config)
        self._fail_at = config.fail_at

    def perform(self, motion: Motion, *, with_trace: bool) -> Outcome:
        self._death.asked()
        if len(self.performed) == self._fail_at:
            raise OverflowError("math range error")
        return super().perform(motion, with_trace=with_trace)


class MortalSimLink(SimLink):
    """The simulator's link of an agent that dies in time."""

    def __init__(self, bus: Bus, stop: threading.Event, death: Death) -> None:
        super().__init__(bus, "main", stop=stop)
        self._death = death

    def step(self, motion: Motion, past: Sequence[PastStep], *, with_trace: bool = False) -> Outcome:
        self._death.asked()
        outcome = super().step(motion, past, with_trace=with_trace)
        self._death.answered()
        return outcome


def serve_sim(config: FakeConfig, bus: Bus, stop: threading.Event) -> None:
    serve_actions(bus, MortalStepper(config), stop)


def serve_planner(config: FakeConfig, bus: Bus, stop: threading.Event) -> None:
    death = Death(config)

    def make_plan(query: PlanQuery) -> Plan:
        death.asked()
        return fake_plan(query)

    serve_plans(bus, one_plan(make_plan), stop)


def run_agent(config: FakeConfig, bus: Bus, stop: threading.Event) -> None:
    with Journal(config.journal, opened()) as journal:
        sim = MortalSimLink(bus, stop, Death(config))
        planner = PlanLink(bus, stop=stop)
        bus.announce()
        episode = Episode(journal, sim, planner)
        n_iterations = episode.plan(QUERY).n_iterations
        crc = 0
        for motion in mission():
            crc = episode.step(motion).state_crc
        sys.stdout.write(f"{n_iterations} {crc}\n")


if __name__ == "__main__":
    role = sys.argv.pop(1)
    if role == "sim":
        sys.exit(run_process("sim", FakeConfig, serve_sim))
    if role == "planner":
        sys.exit(run_process("planner", FakeConfig, serve_planner))
    sys.exit(run_process("agent", FakeConfig, run_agent))
