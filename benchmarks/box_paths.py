"""`python -m benchmarks.box_paths`: measures how long the planner takes for a path of the box among ten obstacles.

The rooms are random and known to have a way through. Each gets one query as a mission asks it, in this process and with
the scenario's budget of iterations. Every exact path is checked again by other means: the distances from the rectangles
of box and robot, at every waypoint, to the obstacles themselves and to the walls.
"""

from collections import Counter
from dataclasses import dataclass
from time import perf_counter
from typing import Final

import numpy as np
import tyro
from msgspec.structs import replace
from rich.progress import track

from agent_proc.push_model.estimate import PushEstimate
from agent_proc.pushing.queries import query_for_box
from agent_proc.pushing.solvable import solvable_by
from legpush.messages.planning import BoxPathQuery, Plan
from legpush.scenarios.random_room import RandomRoom
from legpush.scenarios.random_scenario import random_scenario
from legpush.scene.faces import FACES, pushed_box
from legpush.scene.footprints import distance_m, distance_to_border_m, obstacle_footprint
from legpush.scene.scenario import Room
from planner_proc.planning import make_plan

ROUNDING_M: Final = 1e-6


@dataclass(frozen=True, kw_only=True)
class Config:
    """Which rooms are planned in."""

    first_seed: int = 80_000
    n_rooms: int = 100
    obstacles: int = 10


def main(config: Config) -> None:
    """Plan in every room, check the paths and print times and clearances."""
    times_s, statuses, clearances_m = [], Counter[str](), []
    for seed in track(range(config.first_seed, config.first_seed + config.n_rooms), description="planning"):
        scenario = random_scenario(RandomRoom(obstacles=config.obstacles), seed, solvable_by(make_plan, seed))
        estimates = {face: PushEstimate(pushed_box(scenario.box, face)) for face in FACES}
        query = query_for_box(scenario, seed, scenario.box.pose.pose(), estimates, None)
        begin_s = perf_counter()
        plan = make_plan(query)
        times_s.append(perf_counter() - begin_s)
        statuses[plan.status] += 1
        if plan.status == "exact":
            clearances_m.append(least_clearance_m(query, plan, scenario.room) - query.clearance_m)
    low, median, high = np.quantile(times_s, (0.05, 0.5, 0.95)).tolist()
    print(f"{config.n_rooms} rooms with {config.obstacles} obstacles: {dict(statuses)}")
    print(f"planning: median {median:.2f} s, 5 to 95 % {low:.2f} to {high:.2f} s, longest {max(times_s):.2f} s")
    n_bad = sum(clearance_m < -ROUNDING_M for clearance_m in clearances_m)
    print(f"exact paths on which box or robot loses the clearance: {n_bad} of {len(clearances_m)}")
    if clearances_m:
        print(f"least clearance beyond what was asked for: {100 * min(clearances_m):.2f} cm")


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


if __name__ == "__main__":
    main(tyro.cli(Config))
