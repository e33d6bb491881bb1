"""The questions to the planner: the way to where the box should be, to where it is, and the path of the box."""

from collections.abc import Mapping
from math import radians
from typing import Final

from msgspec.structs import replace

from agent_proc.frames.station import nominal_obstacle, stand_off, station
from agent_proc.push_model.estimate import PushEstimate
from legpush.geometry import Pose2
from legpush.messages.planning import BoxPathQuery, PushSide, TrunkPathQuery
from legpush.scene.clearance import clearance_at
from legpush.scene.faces import TURN_RAD, pushed_box, pushed_pose
from legpush.scene.footprints import Footprint, box_footprint
from legpush.scene.occupancy import clearance_m, occupancy_grid
from legpush.scene.robot import BODY_LENGTH_M, BODY_WIDTH_M, FOOT_RECTANGLE_RADIUS_M
from legpush.scene.scenario import CALIBRATION_PUSH_M, Face, Scenario

TOLERANCE_SHARE: Final = 0.3
"""Of the goal's tolerances: what a planned path of the box may leave."""
SLACK_M: Final = 1e-3
"""Kept below the clearance that the robot has at the start, so that rounding does not put it inside an obstacle."""


def query_to_nominal_box(scenario: Scenario, seed: int, start: Pose2, face: Face) -> TrunkPathQuery:
    """From far away: to the stand-off behind a face of the box at its nominal pose, around everything that it may
    cover.
    """
    goal = stand_off(scenario, pushed_box(scenario.box, face), pushed_pose(scenario.box.pose.pose(), face))
    return _query(scenario, seed, start, goal, nominal_obstacle(scenario))


def query_to_measured_box(scenario: Scenario, seed: int, start: Pose2, box_pose: Pose2, face: Face) -> TrunkPathQuery:
    """After the hand-over: to the stand-off behind a face of the box at the pose that it has."""
    goal = stand_off(scenario, pushed_box(scenario.box, face), pushed_pose(box_pose, face))
    return _query(scenario, seed, start, goal, box_footprint(scenario.box, box_pose))


def query_for_box(
    scenario: Scenario, seed: int, box_pose: Pose2, estimates: Mapping[Face, PushEstimate], present: Face | None
) -> BoxPathQuery:
    """From where the box is to its goal, pushed at the faces that there are estimates for; the robot may stand at one
    of them already.
    """
    faces = tuple(estimates)
    pushing = scenario.pushing
    return BoxPathQuery(
        grid=occupancy_grid(scenario.room),
        start=box_pose,
        goal=scenario.goal.pose.pose(),
        sides=tuple(_side(scenario, face, estimate) for face, estimate in estimates.items()),
        present_side=faces.index(present) if present in faces else None,
        box=box_footprint(scenario.box, Pose2(x_m=0.0, y_m=0.0, yaw_rad=0.0)),
        walk_clearance_m=clearance_m(scenario.planning),
        side_change_m=pushing.face_change_m,
        clearance_m=pushing.margin_m,
        run_in_m=pushing.run_in_m,
        position_tolerance_m=TOLERANCE_SHARE * scenario.goal.position_tolerance_m,
        angle_tolerance_rad=TOLERANCE_SHARE * radians(scenario.goal.angle_tolerance_deg),
        seed=seed,
        max_iterations=pushing.max_iterations,
        goal_bias=pushing.goal_bias,
        step_m=pushing.step_m,
    )


def calibration_query(
    scenario: Scenario, seed: int, box_pose: Pose2, face: Face, estimate: PushEstimate
) -> BoxPathQuery:
    """As far straight ahead as the pushes of a calibration take the box at most, from where the robot stands."""
    reach_m = scenario.pushing.calibration_pushes * CALIBRATION_PUSH_M
    ahead = pushed_pose(box_pose, face) @ Pose2(x_m=reach_m, y_m=0.0, yaw_rad=-TURN_RAD[face])
    query = query_for_box(scenario, seed, box_pose, {face: estimate}, face)
    return replace(query, goal=ahead, run_in_m=0.0, max_iterations=1)


def _side(scenario: Scenario, face: Face, estimate: PushEstimate) -> PushSide:
    """What pushing a face takes: box and robot, and beforehand the place where the robot's way to it ends."""
    box = pushed_box(scenario.box, face)
    here = Pose2(x_m=estimate.axle_m, y_m=0.0, yaw_rad=0.0)
    return PushSide(
        frame=Pose2(x_m=0.0, y_m=0.0, yaw_rad=TURN_RAD[face]) @ Pose2(x_m=-estimate.axle_m, y_m=0.0, yaw_rad=0.0),
        min_turning_radius_m=scenario.pushing.turning_reserve * estimate.turning_radius_m,
        footprints=(
            box_footprint(box, here),
            Footprint(pose=station(box, here), length_m=BODY_LENGTH_M, width_m=BODY_WIDTH_M),
        ),
        stand_off=stand_off(scenario, box, here),
    )


def _query(scenario: Scenario, seed: int, start: Pose2, goal: Pose2, box: Footprint) -> TrunkPathQuery:
    """Ask as the scenario says.

    A robot that has come closer to an obstacle than planned keeps the clearance it has, but at least its footprint's.
    """
    planning = scenario.planning
    grid = occupancy_grid(scenario.room, [box])
    present_m = clearance_at(grid, start) - SLACK_M
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
        steering=planning.steering,
        min_turning_radius_m=planning.min_turning_radius_m,
        smoothing=planning.smoothing,
        anytime=planning.anytime,
    )
