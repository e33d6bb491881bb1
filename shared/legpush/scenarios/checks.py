"""Checks that a scenario can be carried out: everything is inside the room, with enough space around it.

Robot and box are checked with the largest offsets that a seed may draw, so the result holds for every seed. An obstacle
that appears later may be anywhere in the room, since it waits until nothing is in its place.
"""

from collections.abc import Callable, Iterator, Sequence
from math import degrees, hypot, radians, sin
from typing import Final

import numpy as np

from legpush.arrays import Floats
from legpush.bounds import MAX_CELLS
from legpush.errors import ScenarioError
from legpush.geometry import Pose2, wrap_angle
from legpush.scenarios.realism_checks import realism_faults
from legpush.scene.faces import PUSHABLE, pushed_box, pushed_pose
from legpush.scene.footprints import (
    Footprint,
    behind_box,
    box_footprint,
    distance_m,
    distance_to_border_m,
    distance_to_point_m,
    obstacle_footprint,
    robot_footprint,
)
from legpush.scene.names import Face
from legpush.scene.occupancy import clearance_m, grid_shape
from legpush.scene.plan_settings import PlanSettings, radius_fault
from legpush.scene.reference import Reference, first_straight_m, reference_curve
from legpush.scene.scenario import Rectangle, Room, Scenario

REFERENCE_END_M: Final = 0.01
REFERENCE_END_DEG: Final = 0.5
"""Largest distance and angle between the goal and the end of the reference."""
REFERENCE_EVERY: Final = 5
"""Check the space at every fifth point of the reference."""


def check_scenario(scenario: Scenario, where: str = "scenario") -> None:
    """Check that a scenario can be carried out.

    Raises:
        ScenarioError: It cannot. Each text begins with `where`, names the field, and says by how much it is wrong.
    """
    if faults := scenario_faults(scenario):
        raise ScenarioError(*(f"{where}: {fault}" for fault in faults))


class _Faults(list[str]):
    """The faults that were found."""

    def find(self, check: Callable[[], None]) -> bool:
        """Make a check, and return whether it passed."""
        try:
            check()
        except ScenarioError as error:
            self.append(str(error))
            return False
        return True


def scenario_faults(scenario: Scenario) -> list[str]:
    """Return everything that keeps a scenario from being carried out, from the room to the goal.

    What follows from another fault is not told.
    """
    room, box, offsets = scenario.room, scenario.box, scenario.randomization
    faults = _Faults()
    faults.find(lambda: _check_room(room))
    faults.find(lambda: _check_planning(scenario.planning))
    faults += realism_faults(scenario)

    start, box_pose, goal_pose = scenario.start.pose(), box.pose.pose(), scenario.goal.pose.pose()
    start_reach = hypot(offsets.start_xy_m, offsets.start_xy_m)
    box_reach = hypot(offsets.box_xy_m, offsets.box_xy_m) + _turn_reach(hypot(*box.size_m[:2]) / 2, offsets.box_yaw_deg)
    clear = clearance_m(scenario)
    start_fits = faults.find(lambda: _check_circle(room, start, clear, start_reach, "start", "the robot's trunk"))
    box_fits = faults.find(lambda: _check_box(room, box_footprint(box, box_pose), box_reach, "box.pose", "the box"))
    goal_fits = faults.find(
        lambda: _check_box(room, box_footprint(box, goal_pose), 0.0, "goal.pose", "the box at its goal")
    )
    if start_fits and box_fits:
        faults.find(lambda: _check_gap(scenario, start_reach, box_reach))

    faces = tuple(face for face in scenario.pushing.faces if face in PUSHABLE[box.shape])
    if not faces:
        valid = ", ".join(PUSHABLE[box.shape])
        faults.append(
            f"at `pushing.faces`: expected a face that a {box.shape} can be pushed at ({valid}), "
            f"got {', '.join(scenario.pushing.faces)}"
        )
        return faults
    reference = scenario.reference
    if reference is not None:
        faults.find(lambda: _check_reference(scenario, reference))
        faces = ("rear",)
    if box_fits:
        faults.find(lambda: _check_any(faces, lambda face: _check_place_to_begin(scenario, face)))
    if goal_fits:
        faults.find(lambda: _check_any(faces, lambda face: _check_place_to_end(scenario, face)))
    return faults


def _check_gap(scenario: Scenario, start_reach_m: float, box_reach_m: float) -> None:
    """Check that the robot does not stand where the box is."""
    stance, foot_radius_m = scenario.robot.stance, scenario.robot.legs.foot_radius_m
    feet = Footprint(
        pose=scenario.start.pose(),
        length_m=stance.foot_rectangle_length_m + 2 * foot_radius_m,
        width_m=stance.foot_rectangle_width_m + 2 * foot_radius_m,
    )
    foot_reach_m = start_reach_m + _turn_reach(stance.foot_circle_m, scenario.randomization.start_yaw_deg)
    gap_m = distance_m(feet, box_footprint(scenario.box, scenario.box.pose.pose()))
    because = _because(0.0, foot_reach_m + box_reach_m)
    _require(gap_m, foot_reach_m + box_reach_m, "start", "between the robot's feet and the box", because)


def _check_any(faces: Sequence[Face], check: Callable[[Face], None]) -> None:
    """Check that one of the faces passes; otherwise raise the error of the first one."""
    errors: list[ScenarioError] = []
    for face in faces:
        try:
            return check(face)
        except ScenarioError as error:
            errors.append(error)
    raise errors[0] if len(errors) == 1 else ScenarioError(f"{errors[0]}; nor is there space at another face")


def _check_place_to_begin(scenario: Scenario, face: Face) -> None:
    """Check that the robot can come to stand behind a face of the box."""
    offsets, robot = scenario.randomization, scenario.robot
    box, pose = pushed_box(scenario.box, face), pushed_pose(scenario.box.pose.pose(), face)
    for back_m, what in (
        (robot.pushing.stand_off_m, "the robot's place where walking ends"),
        (robot.station_m, "the robot's place to push"),
    ):
        behind = behind_box(box, pose, back_m)
        swing = _turn_reach(box.size_m[0] / 2 + back_m, offsets.box_yaw_deg) + hypot(offsets.box_xy_m, offsets.box_xy_m)
        clear = clearance_m(scenario)
        where = f"{what}, {back_m:.2f} m behind the {face} face,"
        _check_circle(scenario.room, behind, clear, swing, "box.pose", where)


def _check_place_to_end(scenario: Scenario, face: Face) -> None:
    """Check that the robot can stand behind a face of the box at its goal."""
    box, pose = pushed_box(scenario.box, face), pushed_pose(scenario.goal.pose.pose(), face)
    behind = behind_box(box, pose, scenario.robot.station_m)
    what = f"the robot's place behind the {face} face of the box at its goal"
    _check_circle(scenario.room, behind, scenario.robot.stance.foot_circle_m, 0.0, "goal.pose", what)


def _check_planning(planning: PlanSettings) -> None:
    """Check that a steering has its turning radius, and that better paths while walking are not asked for with curves.

    Straight lines join a better path.
    """
    if fault := radius_fault(planning):
        raise ScenarioError(f"at `planning.min_turning_radius_m`: {fault[:1].lower()}{fault[1:]}")
    curved = planning.steering != "straight" or planning.min_turning_radius_m > 0.0
    if planning.anytime is not None and curved:
        raise ScenarioError(
            "at `planning.anytime`: expected the steering straight and no min_turning_radius_m with better paths while "
            f"walking, got {planning.steering} and {planning.min_turning_radius_m:g} m"
        )


def _check_reference(scenario: Scenario, reference: Reference) -> None:
    """Check that the reference ends at the goal, and that box and robot have space all along it."""
    if "rear" not in scenario.pushing.faces:
        raise ScenarioError(
            f"at `pushing.faces`: expected the rear face, at which a reference is pushed, "
            f"got {', '.join(scenario.pushing.faces)}"
        )
    push_m = scenario.robot.pushing.calibration_push_m
    needed_m = scenario.pushing.calibration_pushes * push_m
    if needed_m > (straight_m := first_straight_m(reference)):
        raise ScenarioError(
            f"at `pushing.calibration_pushes`: expected at most {int(straight_m / push_m)}, which fit on "
            f"the straight beginning of the reference ({straight_m:g} m, {push_m} m each), got "
            f"{scenario.pushing.calibration_pushes}"
        )
    curve = reference_curve(reference, scenario.box.pose.pose())
    x_m, y_m, yaw_rad = curve[-1].tolist()
    end, goal = Pose2(x_m=x_m, y_m=y_m, yaw_rad=wrap_angle(yaw_rad)), scenario.goal.pose.pose()
    off_m = hypot(end.x_m - goal.x_m, end.y_m - goal.y_m)
    if off_m > REFERENCE_END_M or degrees(abs(wrap_angle(end.yaw_rad - goal.yaw_rad))) > REFERENCE_END_DEG:
        raise ScenarioError(
            f"at `goal.pose`: expected the end of the reference, x_m {end.x_m:.3f}, y_m {end.y_m:.3f}, "
            f"yaw_deg {degrees(end.yaw_rad):.2f}, got x_m {goal.x_m:g}, y_m {goal.y_m:g}, "
            f"yaw_deg {degrees(goal.yaw_rad):g}"
        )
    for x_m, y_m, yaw_rad in curve[::REFERENCE_EVERY].tolist():
        pose = Pose2(x_m=x_m, y_m=y_m, yaw_rad=wrap_angle(yaw_rad))
        where = f"at ({x_m:.2f}, {y_m:.2f}) on the reference"
        behind = behind_box(scenario.box, pose, scenario.robot.station_m)
        robot = robot_footprint(scenario.robot, behind)
        for footprint, what in ((box_footprint(scenario.box, pose), "the box"), (robot, "the robot")):
            margin_m = scenario.pushing.margin_m
            _check_box(scenario.room, footprint, margin_m, "reference", f"{what} {where}", " (`pushing.margin_m`)")


def _check_room(room: Room) -> None:
    """Check that the map fits into a message, and that no obstacle is outside the room."""
    n_columns, n_rows = grid_shape(room)
    if n_columns * n_rows > MAX_CELLS:
        raise ScenarioError(
            f"at `room.resolution_m`: expected at most {MAX_CELLS} cells of {room.resolution_m} m in "
            f"{room.size_m[0]} x {room.size_m[1]} m, got {n_columns * n_rows}"
        )
    width_m, height_m = room.size_m
    for index, wall in enumerate(room.obstacles):
        if wall.x_max_m <= 0.0 or wall.y_max_m <= 0.0 or wall.x_min_m >= width_m or wall.y_min_m >= height_m:
            raise ScenarioError(
                f"at `room.obstacles[{index}]`: expected a rectangle in the room, x 0 to {width_m}, y 0 to {height_m}, "
                f"got x {wall.x_min_m} to {wall.x_max_m}, y {wall.y_min_m} to {wall.y_max_m}"
            )


def _check_circle(room: Room, centre: Pose2, radius_m: float, reach_m: float, field: str, what: str) -> None:
    """Check that a circle about a pose is free after any offset of the seed, up to `reach_m`."""
    because = _because(radius_m, reach_m)
    point = centre.xy()
    border = distance_to_border_m(point[np.newaxis], room)
    _require_inside(border, field, what)
    _require(border, radius_m + reach_m, field, f"from {what} to the border of the room", because)
    for index, wall in _near(room, point[np.newaxis], radius_m + reach_m):
        distance = distance_to_point_m(obstacle_footprint(wall), point)
        _require(distance, radius_m + reach_m, field, f"from {what} to `room.obstacles[{index}]`", because)


def _check_box(
    room: Room, footprint: Footprint, reach_m: float, field: str, what: str, because: str | None = None
) -> None:
    """Check that a box is free at a distance of `reach_m`: after any offset of the seed, or for the given reason."""
    because = _because(0.0, reach_m) if because is None else because
    corners = footprint.corners()
    border = distance_to_border_m(corners, room)
    _require_inside(border, field, what)
    _require(border, reach_m, field, f"from {what} to the border of the room", because)
    for index, wall in _near(room, corners, reach_m):
        distance = distance_m(obstacle_footprint(wall), footprint)
        _require(distance, reach_m, field, f"from {what} to `room.obstacles[{index}]`", because)


def _near(room: Room, points: Floats, reach_m: float) -> Iterator[tuple[int, Rectangle]]:
    """Yield the obstacles within `reach_m` along both axes of the bounding box of points, (n, 2), with their indices.

    Obstacles that appear later are left out.
    """
    (x_low, y_low), (x_high, y_high) = points.min(axis=0).tolist(), points.max(axis=0).tolist()
    for index, wall in enumerate(room.obstacles):
        along_x_m = max(wall.x_min_m - x_high, x_low - wall.x_max_m)
        along_y_m = max(wall.y_min_m - y_high, y_low - wall.y_max_m)
        if wall.appears_at_s == 0.0 and along_x_m < reach_m and along_y_m < reach_m:
            yield index, wall


def _require(distance: float, least_m: float, field: str, between: str, because: str) -> None:
    """Check that a distance is at least `least_m`; a negative distance is that of an overlap."""
    if distance < least_m:
        least = f"at least {least_m:.3f} m" if least_m > 0.0 else "a distance"
        short = f"{distance:.3f} m: {least_m - distance:.3f} m too little"
        got = short if distance > 0.0 else f"an overlap of {-distance:.3f} m"
        raise ScenarioError(f"at `{field}`: expected {least} {between}{because}, got {got}")


def _require_inside(border_m: float, field: str, what: str) -> None:
    """Check that something is in the room; a negative distance is that outside."""
    if border_m < 0.0:
        raise ScenarioError(f"at `{field}`: expected {what.rstrip(',')} in the room, got it {-border_m:.3f} m outside")


def _because(radius_m: float, reach_m: float) -> str:
    """Return the parts of a least distance as a text in parentheses; empty if it has none."""
    parts = [f"{radius_m:.3f} m for the robot"] * (radius_m > 0.0) + [f"{reach_m:.3f} m for `randomization`"] * (
        reach_m > 0.0
    )
    return f" ({' and '.join(parts)})" if parts else ""


def _turn_reach(arm_m: float, half_width_deg: float) -> float:
    """Return how far the end of an arm moves when the arm turns by up to `half_width_deg`."""
    return 2 * arm_m * sin(radians(min(half_width_deg, 180.0)) / 2)
