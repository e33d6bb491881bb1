"""Checks whether a planner finds a way through a room that was drawn at random."""

from collections.abc import Callable
from typing import Final

from msgspec.structs import replace

from agent_proc.push_model.estimate import PushEstimate
from agent_proc.pushing.queries import query_for_box
from legpush.messages.planning import Plan, PlanQuery
from legpush.plans.trunk_queries import query_to_nominal_box
from legpush.scene.faces import PUSHABLE, pushed_box
from legpush.scene.scenario import Scenario

BUDGET: Final = 2
"""A room counts as solvable if the planner finds a way within this many times the iterations of a mission."""
CHECK_SEED: Final = 1_000_003
"""Offset from the seed of a mission, so that the check is not the search of the mission itself."""


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
