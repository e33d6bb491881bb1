"""Random rooms as a program: `legpush scenarios random FILE`."""

import sys
from typing import Final

from agent_proc.pushing.solvable import solvable_by
from legpush.bus.bus import Bus
from legpush.errors import StopRequestedError
from legpush.options.scenarios import RandomScenario
from legpush.output.reply import document
from legpush.patience import Patience
from legpush.plans.client import PlanLink
from legpush.processes.pool import SimPool
from legpush.runs.temporary import temporary_folder
from legpush.scenarios.file import write_scenario
from legpush.scenarios.random_scenario import random_scenario
from legpush.service import run_command, stop_on_signals

DEADLINE_S: Final = 900.0
"""Deadline of the planner: a room without a way takes minutes on a slow machine."""


def main() -> int:
    """Parse the command line and draw; returns the exit code."""
    return run_command("scenarios random", RandomScenario, run)


def run(options: RandomScenario) -> int:
    """Draw rooms until a planner process finds a way through one, and write it; returns the exit code.

    Raises:
        StopRequestedError: The user interrupted it; nothing is written.
    """
    stop = stop_on_signals()
    with (
        temporary_folder("rooms-") as logs,
        SimPool(1, logs, stop, kind="scenarios", role="planner") as pool,
        Bus(pool.run, "agent", "main", pool.endpoints) as bus,
    ):
        link = PlanLink(bus, stop=stop, patience=Patience(deadline_s=DEADLINE_S))
        bus.announce()
        try:
            scenario = random_scenario(options, options.seed, solvable_by(link.plan, options.seed))
        except StopRequestedError as error:
            raise StopRequestedError("interrupted: nothing was written") from error
    sys.stdout.write(f"wrote {write_scenario(scenario, options.file)}\n")
    document({"file": options.file, "scenario": scenario})
    return 0
