"""Walks around the box from one face to another on an open floor, without a planner."""

from collections.abc import Callable
from math import atan2, ceil, cos, pi, sin
from typing import Final

from legpush.geometry import Pose2, distance_m, wrap_angle
from legpush.messages.poses import as_seen, planar_pose
from legpush.messages.stepping import Follow, Motion, Outcome, Walk, WorldState
from legpush.scene.faces import pushed_box, pushed_pose
from legpush.scene.names import Face
from legpush.scene.scenario import Scenario
from legpush.scene.station import at_station, last_stretch, stand_off, way_back

ARC_STEP_M: Final = 0.1
"""Distance between the waypoints around the box."""
MOST_CYCLES: Final = 200
"""Gait cycles after which a walk is given up. A walk to the opposite face takes about forty."""

Step = Callable[[Motion], Outcome]


def can_push(seen: WorldState, scenario: Scenario, face: Face) -> bool:
    """Whether the robot is at its station behind a face; a push from elsewhere is refused."""
    box, box_w = pushed_box(scenario.box, face), pushed_pose(planar_pose(seen.box), face)
    return at_station(scenario.robot, planar_pose(seen.trunk), box, box_w)


def walk_to_face(step: Step, scenario: Scenario, outcome: Outcome, face: Face) -> Outcome:
    """Walk to the station behind a face of the box, if the robot is not there; return the last outcome.

    `outcome` is that of the last motion. The robot goes where it perceives the box. It may fall, or miss the station.
    """
    seen = as_seen(outcome.world)
    if can_push(seen, scenario, face):
        return outcome
    way = way_around(scenario, planar_pose(seen.trunk), planar_pose(seen.box), face)
    outcome = step(Follow(waypoints=way))
    for _ in range(MOST_CYCLES):
        path = outcome.world.path
        if path is None or path.done or outcome.world.fallen:
            break
        outcome = step(Walk())
    return outcome


def way_around(scenario: Scenario, trunk: Pose2, box: Pose2, face: Face) -> tuple[Pose2, ...]:
    """Waypoints back from the box, along a circle around it, and up to the station behind a face."""
    back = way_back(scenario, trunk, box)
    there, to = pushed_box(scenario.box, face), pushed_pose(box, face)
    begin, end = back[-1], stand_off(scenario, there, to)
    begin_rad, end_rad = _bearing_rad(box, begin), _bearing_rad(box, end)
    begin_m, end_m = distance_m(box, begin), distance_m(box, end)
    turn_rad = wrap_angle(end_rad - begin_rad)
    n = max(1, ceil(abs(turn_rad) * max(begin_m, end_m) / ARC_STEP_M))
    arc = []
    for k in range(n + 1):
        at_rad, at_m = begin_rad + turn_rad * k / n, begin_m + (end_m - begin_m) * k / n
        heading_rad = wrap_angle(at_rad + (pi / 2 if turn_rad > 0.0 else -pi / 2))
        arc.append(Pose2(x_m=box.x_m + at_m * cos(at_rad), y_m=box.y_m + at_m * sin(at_rad), yaw_rad=heading_rad))
    return (*back, *arc, end, *last_stretch(scenario, there, to))


def _bearing_rad(box: Pose2, place: Pose2) -> float:
    """Direction from the box to a place, world frame."""
    return atan2(place.y_m - box.y_m, place.x_m - box.x_m)
