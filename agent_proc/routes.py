"""The two questions to the planner: the way to where the box should be, and the way to where it is."""

import numpy as np

from agent_proc.station import nominal_obstacle, stand_off
from legpush.geometry import Pose2
from legpush.messages import OccupancyGrid, TrunkPathQuery
from legpush.robot import FOOT_RECTANGLE_RADIUS_M
from legpush.room import clearance_m, occupancy_grid
from legpush.room_shapes import Footprint, box_footprint
from legpush.scenario import Scenario

SLACK_M = 1e-3
"""Kept below the clearance that the robot has at the start, so that rounding does not put it inside an obstacle."""


def query_to_nominal_box(scenario: Scenario, seed: int, start: Pose2) -> TrunkPathQuery:
    """From far away: to the stand-off at the box's nominal pose, around everything that the box may cover."""
    goal = stand_off(scenario, scenario.box.pose.pose())
    return _query(scenario, seed, start, goal, nominal_obstacle(scenario))


def query_to_measured_box(scenario: Scenario, seed: int, start: Pose2, box_pose: Pose2) -> TrunkPathQuery:
    """After the hand-over: to the stand-off at the pose that the box has."""
    return _query(scenario, seed, start, stand_off(scenario, box_pose), box_footprint(scenario.box, box_pose))


def _query(scenario: Scenario, seed: int, start: Pose2, goal: Pose2, box: Footprint) -> TrunkPathQuery:
    """Ask as the scenario says.

    A robot that has come closer to an obstacle than planned keeps the clearance it has, but at least its footprint's.
    """
    planning = scenario.planning
    grid = occupancy_grid(scenario.room, [box])
    present_m = distance_to_occupied_m(grid, start) - SLACK_M
    return TrunkPathQuery(
        grid=grid,
        start=start,
        goal=goal,
        clearance_m=max(min(clearance_m(planning), present_m), FOOT_RECTANGLE_RADIUS_M),
        planner=planning.planner,
        seed=seed,
        max_iterations=planning.max_iterations,
        goal_bias=planning.goal_bias,
        step_m=planning.step_m,
        goal_region_m=planning.goal_region_m,
    )


def distance_to_occupied_m(grid: OccupancyGrid, pose: Pose2) -> float:
    """From a position in the grid to the nearest occupied cell or to the grid's border."""
    occupied = np.frombuffer(grid.cells, dtype=np.uint8).reshape(grid.n_rows, grid.n_columns)
    rows, columns = np.nonzero(occupied)
    point = pose.xy() - np.array(grid.origin_m)
    half_cell = grid.resolution_m / 2
    centres = (np.stack([columns, rows], axis=-1) + 0.5) * grid.resolution_m
    beyond = np.maximum(np.abs(centres - point) - half_cell, 0.0)
    extent = np.array([grid.n_columns, grid.n_rows]) * grid.resolution_m
    to_border = np.minimum(point, extent - point).min()
    return float(np.hypot(*beyond.T).min(initial=max(to_border, 0.0)))
