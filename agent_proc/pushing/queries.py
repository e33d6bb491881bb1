"""Queries for paths of the box."""

from collections.abc import Mapping
from math import radians
from typing import Final

from msgspec.structs import replace

from agent_proc.push_model.estimate import PushEstimate
from agent_proc.pushing.docking.moves import PUSH_S, QUARTER_S
from legpush.geometry import ORIGIN, Pose2
from legpush.messages.planning import BoxPathQuery, PushSide
from legpush.scene.faces import TURN_RAD, pushed_box, pushed_pose
from legpush.scene.footprints import box_footprint, robot_footprint
from legpush.scene.names import Face
from legpush.scene.occupancy import clearance_m, occupancy_grid
from legpush.scene.scenario import Scenario
from legpush.scene.station import stand_off, station

TOLERANCE_SHARE: Final = 0.3
"""Share of the goal's tolerances that the end of a planned path may be off."""


def query_for_box(
    scenario: Scenario, seed: int, box_pose: Pose2, estimates: Mapping[Face, PushEstimate], present: Face | None
) -> BoxPathQuery:
    """Query for a path of the box from where it is to its goal, pushed at the faces of `estimates`.

    `present` is the face that the robot stands at, if it does.
    """
    faces = tuple(estimates)
    pushing = scenario.pushing
    return BoxPathQuery(
        grid=occupancy_grid(scenario.room),
        start=box_pose,
        goal=scenario.goal.pose.pose(),
        sides=tuple(_side(scenario, face, estimate) for face, estimate in estimates.items()),
        present_side=faces.index(present) if present in faces else None,
        box=box_footprint(scenario.box, ORIGIN),
        walk_clearance_m=clearance_m(scenario),
        body=robot_footprint(scenario.robot, ORIGIN),
        body_clearance_m=scenario.planning.body_margin_m,
        side_change_m=_side_change_m(estimates) if pushing.face_change_m is None else pushing.face_change_m,
        clearance_m=pushing.margin_m,
        run_in_m=pushing.run_in_m,
        position_tolerance_m=TOLERANCE_SHARE * scenario.goal.position_tolerance_m,
        angle_tolerance_rad=TOLERANCE_SHARE * radians(scenario.goal.angle_tolerance_deg),
        seed=seed,
        max_iterations=pushing.max_iterations,
        goal_bias=pushing.goal_bias,
        step_m=pushing.step_m,
    )


def closer(query: BoxPathQuery, scenario: Scenario) -> BoxPathQuery:
    """The same query, with no more clearance than box and robot need, pushing and walking; the body keeps its own."""
    return replace(query, clearance_m=0.0, walk_clearance_m=scenario.robot.stance.body_width_m / 2)


def calibration_query(
    scenario: Scenario, seed: int, box_pose: Pose2, face: Face, estimate: PushEstimate
) -> BoxPathQuery:
    """Query for a straight path of the box, as long as the pushes of a calibration may take it."""
    reach_m = scenario.pushing.calibration_pushes * scenario.robot.pushing.calibration_push_m
    ahead = pushed_pose(box_pose, face) @ Pose2(x_m=reach_m, y_m=0.0, yaw_rad=-TURN_RAD[face])
    query = query_for_box(scenario, seed, box_pose, {face: estimate}, face)
    return replace(query, goal=ahead, run_in_m=0.0, max_iterations=1)


def _side_change_m(estimates: Mapping[Face, PushEstimate]) -> float:
    """How far pushes move the box while the robot walks to a face beside the present one."""
    per_push_m = sum(estimate.path_travel_m for estimate in estimates.values()) / len(estimates)
    return QUARTER_S / PUSH_S * per_push_m


def _side(scenario: Scenario, face: Face, estimate: PushEstimate) -> PushSide:
    """What pushing at a face needs: room for box and robot, and for the robot at the stand-off before."""
    box = pushed_box(scenario.box, face)
    here = Pose2(x_m=estimate.axle_m, y_m=0.0, yaw_rad=0.0)
    return PushSide(
        frame=Pose2(x_m=0.0, y_m=0.0, yaw_rad=TURN_RAD[face]) @ Pose2(x_m=-estimate.axle_m, y_m=0.0, yaw_rad=0.0),
        min_turning_radius_m=scenario.pushing.turning_reserve * estimate.turning_radius_m,
        footprints=(
            box_footprint(box, here),
            robot_footprint(scenario.robot, station(scenario.robot, box, here)),
        ),
        stand_off=stand_off(scenario, box, here),
    )
