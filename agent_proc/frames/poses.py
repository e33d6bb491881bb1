"""What the agent reads out of a world state: planar poses and how far the box is from its goal."""

from dataclasses import dataclass
from math import acos, degrees

from legpush.geometry import Pose2, distance_m, wrap_angle
from legpush.messages.poses import planar_pose
from legpush.messages.stepping import WorldState
from legpush.scene.robot import FOOT_RECTANGLE_RADIUS_M
from legpush.scene.scenario import Goal, Scenario


@dataclass(frozen=True, kw_only=True)
class BoxError:
    """How far the box is from its goal pose."""

    position_m: float
    angle_rad: float
    """Without sign."""

    def within(self, goal: Goal) -> bool:
        """Whether both parts are inside the goal's tolerances."""
        return self.position_m <= goal.position_tolerance_m and degrees(self.angle_rad) <= goal.angle_tolerance_deg

    def __str__(self) -> str:
        """Metres and degrees, for people."""
        return f"{self.position_m:.3f} m, {degrees(self.angle_rad):.1f}°"


def box_tilt_rad(world: WorldState) -> float:
    """Angle between the box's upward axis and the vertical."""
    _, x, y, _ = world.box.orientation_wxyz
    return acos(max(-1.0, min(1.0, 1.0 - 2.0 * (x * x + y * y))))


def moved_m(a: Pose2, b: Pose2) -> float:
    """Distance between two poses; a turn counts by the arc of the foot rectangle's corners."""
    return distance_m(a, b) + abs(wrap_angle(b.yaw_rad - a.yaw_rad)) * FOOT_RECTANGLE_RADIUS_M


def box_error(world: WorldState, scenario: Scenario) -> BoxError:
    """Error of the box's centre and yaw against the goal pose of the scenario."""
    return pose_error(planar_pose(world.box), scenario.goal.pose.pose())


def pose_error(box: Pose2, goal: Pose2) -> BoxError:
    """Error of a box at one pose that should be at another one."""
    return BoxError(position_m=distance_m(box, goal), angle_rad=abs(wrap_angle(box.yaw_rad - goal.yaw_rad)))
