"""Checks whether a planner finds a way through a room that was drawn at random."""

from collections.abc import Callable
from math import radians
from typing import Final

from msgspec.structs import replace

from agent_proc.push_model.estimate import PushEstimate
from agent_proc.pushing.queries import query_for_box
from legpush.geometry import Pose2, wrap_angle
from legpush.messages.planning import Plan, PlanQuery
from legpush.plans.trunk_queries import query_to_nominal_box
from legpush.scene.faces import PUSHABLE, pushed_box
from legpush.scene.names import Face
from legpush.scene.scenario import Scenario

BUDGET: Final = 2
"""A room counts as solvable if the planner finds a way within this many times the iterations of a mission."""
CHECK_SEED: Final = 1_000_003
"""Offset from the seed of a mission, so that the check is not the search of the mission itself."""


def solvable_by(plan: Callable[[PlanQuery], Plan], seed: int) -> Callable[[Scenario], bool]:
    """Make a check that a planner finds a path of the box, and one of the robot to its first face.

    The path of the box has to exist from its nominal place and from the corners of where a seed may put it.
    """

    def is_solvable(scenario: Scenario) -> bool:
        box, pushing = scenario.box, scenario.pushing
        check_seed = (seed + CHECK_SEED) % 2**32
        faces = tuple(face for face in pushing.faces if face in PUSHABLE[box.shape])
        estimates = {face: PushEstimate(pushed_box(box, face)) for face in faces}
        queries = [query_for_box(scenario, check_seed, place, estimates, None) for place in _places(scenario)]
        first: Face | None = None
        for query in queries:
            found = plan(replace(query, max_iterations=BUDGET * pushing.max_iterations))
            if found.status != "exact":
                return False
            first = first or faces[found.sides[0]]
        return (
            first is not None
            and plan(query_to_nominal_box(scenario, check_seed, scenario.start.pose(), first)).status == "exact"
        )

    return is_solvable


def _places(scenario: Scenario) -> tuple[Pose2, ...]:
    """The nominal pose of the box, and those farthest from it that a seed may give it, turned this way and that."""
    nominal, offsets = scenario.box.pose.pose(), scenario.randomization
    off_m, off_rad = offsets.box_xy_m, radians(offsets.box_yaw_deg)
    return tuple(
        Pose2(
            x_m=nominal.x_m + x * off_m,
            y_m=nominal.y_m + y * off_m,
            yaw_rad=wrap_angle(nominal.yaw_rad + turn * off_rad),
        )
        for x, y, turn in ((0, 0, 0), (1, 1, 1), (-1, -1, -1), (1, -1, -1), (-1, 1, 1))
    )
