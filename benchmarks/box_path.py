"""The kind of cell that plans a path of the box in a random room, and checks it by other means.

The room is known to have a way through. It gets one query as a mission asks it, with the scenario's budget of
iterations. An exact path is checked again: the distances from the rectangles of box and robot, at every waypoint, to
the obstacles themselves and to the walls.
"""

from collections.abc import Mapping
from time import perf_counter
from typing import Annotated, Any, Final

import numpy as np
from msgspec import Meta, Struct
from msgspec.structs import replace

from agent_proc.push_model.estimate import PushEstimate
from agent_proc.pushing.queries import query_for_box
from agent_proc.pushing.solvable import solvable_by
from legpush.fields import Seed
from legpush.messages.planning import BoxPathQuery, Plan
from legpush.scenarios.random_room import RandomRoom
from legpush.scenarios.random_scenario import random_scenario
from legpush.scene.faces import FACES, pushed_box
from legpush.scene.footprints import distance_m, distance_to_border_m, obstacle_footprint
from legpush.scene.scenario import Room
from legpush.study.cells import CellKind, Column, as_it_is
from planner_proc.planning import make_plan

COLUMNS: Final = (
    Column(name="status", unit="", about="exact, approximate, failed or invalid"),
    Column(name="spare_m", unit="m", about="least distance of box and robot to anything, beyond what was asked for"),
    Column(name="planning_s", unit="s", about="time for the path", may_differ=True),
)


class BoxPath(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A room to plan in."""

    seed: Seed
    obstacles: Annotated[int, Meta(ge=0)] = 10


def box_path(cell: BoxPath) -> Mapping[str, Any]:
    """Draw the room, plan in it, and check the path."""
    scenario = random_scenario(RandomRoom(obstacles=cell.obstacles), cell.seed, solvable_by(make_plan, cell.seed))
    estimates = {face: PushEstimate(pushed_box(scenario.box, face)) for face in FACES}
    query = query_for_box(scenario, cell.seed, scenario.box.pose.pose(), estimates, None)
    began_s = perf_counter()
    plan = make_plan(query)
    planning_s = perf_counter() - began_s
    is_exact = plan.status == "exact"
    spare_m = least_clearance_m(query, plan, scenario.room) - query.clearance_m if is_exact else None
    return {"status": plan.status, "spare_m": spare_m, "planning_s": planning_s}


def least_clearance_m(query: BoxPathQuery, plan: Plan, room: Room) -> float:
    """Return the least distance from box and robot to an obstacle or wall, anywhere on the path."""
    solid = [obstacle_footprint(obstacle) for obstacle in room.obstacles]
    least_m = np.inf
    for index, waypoint in zip(plan.sides, plan.waypoints, strict=True):
        for footprint in query.sides[index].footprints:
            placed = replace(footprint, pose=waypoint @ query.sides[index].frame @ footprint.pose)
            least_m = min(least_m, distance_to_border_m(placed.corners(), room))
            least_m = min([least_m, *(distance_m(placed, other) for other in solid)])
    return float(least_m)


BOX_PATH: Final = CellKind(specification=BoxPath, run=box_path, resolved=BoxPath, resolve=as_it_is, columns=COLUMNS)
"""The kind of cell."""
