"""A fake simulator or planner as a real process: `python fake_process.py sim ...`, with the flags of a real one.

`--die-at N` kills it with SIGKILL in the middle of its N-th motion or plan, which then has no answer.
"""

import os
import signal
import sys
import threading
from dataclasses import dataclass

from legpush.bus import Bus
from legpush.lockstep_server import serve_actions
from legpush.messages import Motion, Outcome, Plan, PlanQuery
from legpush.plan_server import serve_plans
from legpush.service import ServiceConfig, run_process

from tests.shared.fakes import FakeStepper, fake_plan


@dataclass(frozen=True, kw_only=True)
class FakeConfig(ServiceConfig):
    """As a real process, and how it is to fail."""

    die_at: int = -1
    """Count of the motion or plan in which it dies."""


class Fake:
    """Counts what it is asked for and dies in time."""

    def __init__(self, config: FakeConfig) -> None:
        self._config = config
        self._stepper = FakeStepper()
        self._n_asked = 0

    def perform(self, motion: Motion, *, with_trace: bool) -> Outcome:
        self._count()
        return self._stepper.perform(motion, with_trace=with_trace)

    def plan(self, query: PlanQuery) -> Plan:
        self._count()
        return fake_plan(query)

    def _count(self) -> None:
        if self._n_asked == self._config.die_at:
            os.kill(os.getpid(), signal.SIGKILL)
        self._n_asked += 1


def serve_sim(config: FakeConfig, bus: Bus, stop: threading.Event) -> None:
    serve_actions(bus, Fake(config), stop)


def serve_planner(config: FakeConfig, bus: Bus, stop: threading.Event) -> None:
    serve_plans(bus, Fake(config).plan, stop)


if __name__ == "__main__":
    role = sys.argv.pop(1)
    sys.exit(
        run_process("sim", FakeConfig, serve_sim)
        if role == "sim"
        else run_process("planner", FakeConfig, serve_planner)
    )
