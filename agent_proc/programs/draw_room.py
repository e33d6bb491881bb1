"""Random rooms as a program: `python -m agent_proc.programs.draw_room FILE`, or `legpush scenarios random FILE`."""

import sys
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

import tyro
from msgspec.structs import replace

from agent_proc.push_model.estimate import PushEstimate
from agent_proc.pushing.queries import query_for_box
from legpush.bus.bus import Bus
from legpush.errors import StopRequestedError
from legpush.messages.planning import Plan, PlanQuery
from legpush.numerics.entry import enter_profile
from legpush.options.scenarios import RandomScenario
from legpush.patience import Patience
from legpush.plans.client import PlanLink
from legpush.plans.trunk_queries import query_to_nominal_box
from legpush.processes.pool import SimPool
from legpush.scenarios.file import write_scenario
from legpush.scenarios.random_scenario import random_scenario
from legpush.scene.faces import PUSHABLE, pushed_box
from legpush.scene.scenario import Scenario
from legpush.service import run_program, stop_on_signals

BUDGET: Final = 2
"""A room counts as solvable if the planner finds a way within this many times the iterations of a mission."""
DEADLINE_S: Final = 900.0
"""Deadline of the planner: a room without a way takes minutes on a slow machine."""
CHECK_SEED: Final = 1_000_003
"""Offset from the seed of a mission, so that the check is not the search of the mission itself."""


def main() -> int:
    """Parse the command line and draw; returns the exit code."""
    return run_program("scenarios", lambda: run(tyro.cli(RandomScenario, prog="legpush scenarios random")))


def run(options: RandomScenario) -> int:
    """Draw rooms until a planner process finds a way through one, and write it; returns the exit code.

    Raises:
        StopRequestedError: The user interrupted it; nothing is written.
    """
    stop = stop_on_signals()
    with (
        TemporaryDirectory(prefix="legpush-rooms-") as logs,
        SimPool(1, Path(logs), stop, kind="scenarios", role="planner") as pool,
        Bus(pool.run, "agent", "main", pool.endpoints) as bus,
    ):
        link = PlanLink(bus, stop=stop, patience=Patience(deadline_s=DEADLINE_S))
        bus.announce()
        try:
            scenario = random_scenario(options, options.seed, solvable_by(link.plan, options.seed))
        except StopRequestedError as error:
            raise StopRequestedError("interrupted: nothing was written") from error
    sys.stdout.write(f"wrote {write_scenario(scenario, options.file)}\n")
    return 0


def solvable_by(plan: Callable[[PlanQuery], Plan], seed: int) -> Callable[[Scenario], bool]:
    """Make a check that a planner finds a path of the nominal box, and one of the robot to its first face."""

    def is_solvable(scenario: Scenario) -> bool:
        box, pushing = scenario.box, scenario.pushing
        check_seed = (seed + CHECK_SEED) % 2**32
        faces = tuple(face for face in pushing.faces if face in PUSHABLE[box.shape])
        estimates = {face: PushEstimate(pushed_box(box, face)) for face in faces}
        query = query_for_box(scenario, check_seed, box.pose.pose(), estimates, None)
        found = plan(replace(query, max_iterations=BUDGET * pushing.max_iterations))
        if found.status != "exact":
            return False
        first = faces[found.sides[0]]
        return plan(query_to_nominal_box(scenario, check_seed, scenario.start.pose(), first)).status == "exact"

    return is_solvable


if __name__ == "__main__":
    enter_profile()
    sys.exit(main())
