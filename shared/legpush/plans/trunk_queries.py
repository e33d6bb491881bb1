"""The questions to the planner: the way to where the box should be, to where it is, and the path of the box."""

from typing import Final

import numpy as np
from msgspec.structs import replace

from legpush.geometry import ORIGIN, Pose2
from legpush.messages.planning import TrunkPathQuery
from legpush.scene.clearance import Occupied
from legpush.scene.faces import pushed_box, pushed_pose
from legpush.scene.footprints import Footprint, box_footprint, robot_footprint
from legpush.scene.names import Face
from legpush.scene.occupancy import clearance_m, occupancy_grid
from legpush.scene.robot import RobotSpec
from legpush.scene.scenario import Scenario
from legpush.scene.station import nominal_obstacle, stand_off

SHRUNK_M: Final = (0.0, 0.01, 0.02, 0.03, 0.04, 0.05, 0.06, 0.08, 0.1)
"""By how much the body may be made smaller on each side, in turn."""
SLACK_M: Final = 1e-3
"""Kept below the clearance that the robot has at the start, so that rounding does not put it inside an obstacle."""


def query_to_nominal_box(scenario: Scenario, seed: int, start: Pose2, face: Face) -> TrunkPathQuery:
    """From far away: to the stand-off behind a face of the box at its nominal pose, around everything that it may
    cover.
    """
    goal = stand_off(scenario, pushed_box(scenario.box, face), pushed_pose(scenario.box.pose.pose(), face))
    return _query(scenario, seed, start, goal, nominal_obstacle(scenario))


def query_to_measured_box(scenario: Scenario, seed: int, start: Pose2, box_pose: Pose2, face: Face) -> TrunkPathQuery:
    """After the hand-over: to the stand-off behind a face of the box where it is now."""
    goal = stand_off(scenario, pushed_box(scenario.box, face), pushed_pose(box_pose, face))
    return _query(scenario, seed, start, goal, box_footprint(scenario.box, box_pose))


def query_to_pose(scenario: Scenario, seed: int, start: Pose2, goal: Pose2, box_pose: Pose2) -> TrunkPathQuery:
    """Ask for a path of the trunk to a pose, around the box where it is now."""
    return _query(scenario, seed, start, goal, box_footprint(scenario.box, box_pose))


def _query(scenario: Scenario, seed: int, start: Pose2, goal: Pose2, box: Footprint) -> TrunkPathQuery:
    """Ask as the scenario says.

    A robot that has come closer to an obstacle than planned keeps the clearance it has, but at least half its width.
    If its body is nearer to something at one of the ends, that distance is the clearance of the body. If it touches an
    occupied cell there, the query has a smaller body, because a cell is larger than what is in it.
    """
    planning, robot = scenario.planning, scenario.robot
    occupied = Occupied(occupancy_grid(scenario.room, [box]))
    present_m = occupied.nearest(start.xy()[np.newaxis]).distance_m - SLACK_M
    body, body_m = _body(occupied, robot, (start, goal))
    return TrunkPathQuery(
        grid=occupied.grid,
        start=start,
        goal=goal,
        clearance_m=max(min(clearance_m(scenario), present_m), robot.stance.body_width_m / 2),
        body=body,
        body_clearance_m=max(min(planning.body_margin_m, body_m), 0.0),
        planner=planning.planner,
        seed=seed,
        max_iterations=planning.max_iterations,
        goal_bias=planning.goal_bias,
        step_m=planning.step_m,
        goal_region_m=planning.goal_region_m,
        steering=planning.steering,
        min_turning_radius_m=planning.min_turning_radius_m,
        smoothing=planning.smoothing,
        anytime=planning.anytime,
    )


def _body(occupied: Occupied, robot: RobotSpec, ends: tuple[Pose2, ...]) -> tuple[Footprint | None, float]:
    """Return the largest body that touches nothing at the ends of a walk, if there is one, and its clearance there."""
    whole = robot_footprint(robot, ORIGIN)
    for less_m in SHRUNK_M:
        body = replace(whole, length_m=whole.length_m - 2 * less_m, width_m=whole.width_m - 2 * less_m)
        apart_m = min(occupied.distance_m(replace(body, pose=end @ body.pose)) for end in ends)
        if apart_m > SLACK_M:
            return body, apart_m - SLACK_M
    return None, 0.0
