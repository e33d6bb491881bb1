"""The box in the frame of its goal, and everything else that a decision about a push depends on."""

from dataclasses import dataclass
from functools import cached_property
from math import atan2, cos, degrees, sin
from typing import Final

from msgspec.structs import replace

from agent_proc.frames.corners import goal_corners_m, tracked_corners_m
from agent_proc.frames.poses import BoxError, pose_error
from agent_proc.push_model.estimate import Drift, FeltBox
from agent_proc.push_model.response import Response, expected_response
from legpush.arrays import Floats
from legpush.geometry import Pose2, wrap_angle
from legpush.messages.poses import planar_pose
from legpush.messages.stepping import BoxState, WorldState
from legpush.scene.faces import TURN_RAD, pushed_box, pushed_pose
from legpush.scene.names import Face
from legpush.scene.scenario import Box, Goal, PoseDeg, Scenario

LOOK_AHEAD_M: Final = 0.25
"""How far ahead on the line through the goal a box should head for."""
NOTHING_FELT: Final = FeltBox()
N_DIGITS: Final = 9
"""The side of the line that the box is on is decided by this many decimals of a metre."""


@dataclass(frozen=True, kw_only=True)
class PushView:
    """A box, the goal that it is pushed to, and the world around them.

    The frame of the box is the pushed one: its x axis is the pushing direction, and the pushed face is the rear one.
    Each derived quantity is computed once, when it is first read.
    """

    world: WorldState
    """Robot and time. Its box has the axes of the scenario: read `box_state` instead."""
    scenario: Scenario
    """Settings and room. Read `box` and `goal` instead of its box and goal."""
    box: Box
    """The box, with its size in the pushed frame."""
    box_state: BoxState
    """Pose of the pushed frame, world frame: measured, or predicted if the box is pushed in an open loop."""
    goal: Goal
    """Pose that the pushed frame should come to, world frame, and its tolerances."""
    felt: FeltBox = NOTHING_FELT
    """What the pushes at this face have shown of the box."""
    face: Face = "rear"
    """The face of the box that is the rear one of the pushed frame."""

    @property
    def lost_depth_m(self) -> float:
        """How much deeper this box has to be pushed than the default one to move as far."""
        return self.felt.lost_depth_m

    @property
    def drift(self) -> Drift:
        """What the last pushes did beyond what the push model expected of them."""
        return self.felt.drift

    @cached_property
    def response(self) -> Response:
        """What a push is expected to do."""
        return expected_response(self.box) if self.felt.response is None else self.felt.response

    @cached_property
    def box_w(self) -> Pose2:
        """Pose of the box on the floor, world frame."""
        return planar_pose(self.box_state)

    @cached_property
    def box_g(self) -> Pose2:
        """Pose of the box in the frame of its goal: x is minus the distance that remains."""
        return box_in_goal_frame(self.box_w, self.goal)

    @cached_property
    def steering_error_rad(self) -> float:
        """Heading of the box, minus the heading that brings it to the line through the goal (pure pursuit)."""
        return wrap_angle(self.box_g.yaw_rad - atan2(-self.box_g.y_m, LOOK_AHEAD_M))

    @cached_property
    def mirror_sign(self) -> float:
        """-1 if the middle of the box's front edge is right of the line through the goal, else 1."""
        edge_g = self.box_g @ Pose2(x_m=self.box.size_m[0] / 2, y_m=0.0, yaw_rad=0.0)
        return -1.0 if round(edge_g.y_m, N_DIGITS) < 0.0 else 1.0

    @cached_property
    def error(self) -> BoxError:
        """How far the box is from its goal."""
        return pose_error(self.box_w, self.goal.pose.pose())

    @cached_property
    def corners_w_m(self) -> Floats:
        """Tracked corners of the box, world frame, (2, 3)."""
        return tracked_corners_m(self.box_state, self.box)

    @cached_property
    def goal_corners_w_m(self) -> Floats:
        """Where the tracked corners should be, world frame, (2, 2)."""
        return goal_corners_m(self.goal, self.box)

    @property
    def fallen(self) -> bool:
        """Whether the robot has fallen."""
        return self.world.fallen


def push_view(world: WorldState, scenario: Scenario, felt: FeltBox = NOTHING_FELT, face: Face = "rear") -> PushView:
    """The view of a box that is pushed at one of its faces to the goal of its scenario."""
    if face == "rear":
        box, goal = scenario.box, scenario.goal
    else:
        to = pushed_pose(scenario.goal.pose.pose(), face)
        pose = PoseDeg(x_m=to.x_m, y_m=to.y_m, yaw_deg=degrees(to.yaw_rad))
        box, goal = pushed_box(scenario.box, face), replace(scenario.goal, pose=pose)
    return PushView(
        world=world,
        scenario=scenario,
        box=box,
        box_state=pushed_state(world.box, face),
        goal=goal,
        felt=felt,
        face=face,
    )


def seen_from(view: PushView, face: Face) -> PushView:
    """The same moment, seen from another face; of what pushes have shown, only the lost depth is that of the box."""
    if face == view.face:
        return view
    return push_view(view.world, view.scenario, FeltBox(lost_depth_m=view.lost_depth_m), face)


def pushed_state(box: BoxState, face: Face) -> BoxState:
    """Pose of the pushed frame of a box: the axes are turned about z until the face is the rear one."""
    if face == "rear":
        return box
    w, x, y, z = box.orientation_wxyz
    c, s = cos(TURN_RAD[face] / 2), sin(TURN_RAD[face] / 2)
    return replace(box, orientation_wxyz=(w * c - z * s, x * c + y * s, y * c - x * s, z * c + w * s))


def box_in_goal_frame(box_w: Pose2, goal: Goal) -> Pose2:
    """Pose of the box in the frame of its goal pose."""
    return goal.pose.pose().inverse() @ box_w
