"""A scenario: the room, the robot's start, the box and its goal pose, as one record that travels in `Reset`."""

from math import radians
from typing import Annotated, Final, Literal

from msgspec import Meta, Struct

from legpush.fields import Name
from legpush.geometry import Pose2
from legpush.scene.reference import Reference
from legpush.scene.robot import HIP_X_M, PUSH_GAP_M

Positive = Annotated[float, Meta(gt=0.0)]
BoxSide = Annotated[float, Meta(ge=0.01)]
NonNegative = Annotated[float, Meta(ge=0.0)]
PlannerName = Literal["rrt", "rrt_connect", "rrt_star", "informed_rrt_star", "bit_star", "prm_star"]
Steering = Literal["straight", "dubins", "reeds_shepp"]
BoxShape = Literal["cuboid", "cylinder", "wedge", "l_shape"]
Face = Literal["rear", "right", "front", "left"]
"""Of a box, seen along its x axis."""
STATION_M: Final = HIP_X_M + PUSH_GAP_M
"""From the box's rear face back to the trunk centre when the robot stands ready to push."""
STAND_OFF_M: Final = 0.75
"""The same distance where walking ends: far enough for the box to count as an obstacle until then."""
CALIBRATION_PUSH_M: Final = 0.06
"""What one push of a calibration moves the box by, at most."""
MAX_OBSTACLES: Final = 10_000


class Rectangle(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """An axis-aligned wall or block that stands on the floor, world frame."""

    x_min_m: float
    x_max_m: float
    y_min_m: float
    y_max_m: float
    appears_at_s: Annotated[float, Meta(ge=0.0, le=1e6)] = 0.0
    """Simulated time from which it stands there, as soon as neither robot nor box is near; 0 is from the start."""

    def __post_init__(self) -> None:
        """Refuse a rectangle without area (`ValueError`)."""
        for low, high in (("x_min_m", "x_max_m"), ("y_min_m", "y_max_m")):
            if not getattr(self, low) < getattr(self, high):
                raise ValueError(f"Expected {low} < {high}, got {getattr(self, low)} and {getattr(self, high)}")


class PoseDeg(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A planar pose as people write it in a file: metres and degrees, world frame."""

    x_m: float
    y_m: float
    yaw_deg: Annotated[float, Meta(ge=-360.0, le=360.0)]

    def pose(self) -> Pose2:
        """The same pose in radians."""
        return Pose2(x_m=self.x_m, y_m=self.y_m, yaw_rad=radians(self.yaw_deg))


class Room(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The floor from (0, 0) to `size_m`, with everything that stands on it; outside is not free."""

    size_m: tuple[Positive, Positive]
    """Extent along x and y."""
    obstacles: Annotated[tuple[Rectangle, ...], Meta(max_length=MAX_OBSTACLES)] = ()
    resolution_m: Positive = 0.05
    """Cell size of the occupancy map that the planner gets."""
    wall_height_m: Positive = 0.6
    slope_deg: Annotated[float, Meta(ge=0.0, le=10.0)] = 0.0
    """Inclination of the whole floor. The world frame is the floor's, z along its normal: what is tilted is gravity,
    and roll and pitch are those against the floor."""
    uphill_deg: Annotated[float, Meta(ge=-360.0, le=360.0)] = 0.0
    """The direction in which the floor rises, about z from the x axis of the world."""


class Box(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The box to be pushed."""

    pose: PoseDeg
    """Nominal pose; x points in the direction in which the box is pushed."""
    size_m: tuple[BoxSide, BoxSide, BoxSide] = (0.4, 0.5, 0.4)
    """Full length (x), width (y) and height, over all."""
    shape: BoxShape = "cuboid"
    """What fills that, with even density: all of it, an upright `cylinder`, a `wedge` as high as that at the rear face
    and down to the floor at the front, or, seen from above, an `l_shape` without the front right quarter."""
    mass_kg: Annotated[float, Meta(ge=0.001)] = 0.1
    friction: Positive = 0.5
    """Sliding friction coefficient, both with the floor and with the foot."""

    def __post_init__(self) -> None:
        """Refuse a cylinder that is not round (`ValueError`)."""
        if self.shape == "cylinder" and self.size_m[0] != self.size_m[1]:
            raise ValueError(
                f"Expected equal length and width of a cylinder in size_m, got {self.size_m[0]} and {self.size_m[1]}"
            )


class Goal(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Where the box has to be, and how exactly, for the mission to succeed."""

    pose: PoseDeg
    position_tolerance_m: Positive = 0.03
    angle_tolerance_deg: Positive = 3.0


class Smoothing(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What is made of the path that the search found; what comes out keeps the clearance in any case."""

    method: Literal["none", "spline", "band"] = "band"
    """`none`: the path itself, with turns on the spot. `spline`: the paper's cubic spline through its corners, drawn
    back to it where that collides. `band`: a spline along an elastic band, which keeps away from obstacles."""
    shorten: bool = True
    """Whether detours are cut off first, where a straight line is free."""
    comfort_m: Annotated[float, Meta(ge=0.0, le=100.0)] = 0.25
    """What a `band` keeps beyond the required clearance, where there is room: turns around a corner get wider."""
    max_deviation_m: Annotated[float, Meta(ge=0.01)] | None = None
    """Farthest from the path of the search, shortened or not; nothing for any distance."""
    max_waypoints: Annotated[int, Meta(ge=10, le=100_000)] = 20_000
    """Of a smooth path: long ones get waypoints farther apart than 0.05 m."""


class Anytime(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Better paths after the first one, each after a fixed number of iterations, so that a run can be repeated."""

    n_improvements: Annotated[int, Meta(ge=1, le=1000)] = 10
    improvement_iterations: Annotated[int, Meta(ge=1, le=1_000_000)] = 500
    """Of each."""


class PlanSettings(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How the planner is asked."""

    planner: PlannerName = "rrt_connect"
    steering: Steering = "straight"
    """How poses are joined: by straight lines with turns on the spot, or by Dubins' arcs and lines forward only, or by
    those of Reeds and Shepp, backward too."""
    min_turning_radius_m: NonNegative = 0.0
    """0 for any; between straight lines, what smoothing makes turns no tighter."""
    max_iterations: Annotated[int, Meta(ge=1, le=10_000_000)] = 20_000
    goal_bias: Annotated[float, Meta(ge=0.0, le=1.0)] = 0.05
    step_m: Positive = 0.5
    """Longest edge of the tree."""
    goal_region_m: Positive = 0.25
    """Radius of the goal region of Algorithm 1."""
    margin_m: NonNegative = 0.1
    """Clearance to keep beyond the footprint's circumscribed circle."""
    smoothing: Smoothing = Smoothing()
    anytime: Anytime | None = None
    """With it, walking begins on the first path found, and a better one may be taken between gait cycles."""


class MissionSettings(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How the agent runs the mission (Fig. 5)."""

    handover_distance_m: Positive = 3.0
    """Trunk-to-box distance at which walking hands over to pushing."""
    max_push_cycles: Annotated[int, Meta(ge=1, le=10_000)] = 200


class PushSettings(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How the box is pushed along a path."""

    composition: Literal["closed_loop", "open_loop"] = "closed_loop"
    """Whether each push depends on where the box has come to, or all are chosen before the first one."""
    calibration_pushes: Annotated[int, Meta(ge=0, le=40)] = 0
    """How often an unknown box is pushed, straight ahead and with both legs in turn, before its path is planned."""
    faces: Annotated[tuple[Face, ...], Meta(min_length=1, max_length=4)] = ("rear", "right", "front", "left")
    """Those that may be pushed."""
    turning_reserve: Annotated[float, Meta(ge=1.0)] = 1.4
    """Least turning radius of a planned path over the one that the box turns at when one foot alone pushes it: what is
    more than 1 leaves room to correct."""
    margin_m: NonNegative = 0.05
    """Clearance of box and robot to everything else."""
    run_in_m: NonNegative = 0.4
    """The path is straight for so long before the goal."""
    face_change_m: NonNegative = 0.5
    """How much more pushing a walk around the box is worth."""
    max_iterations: Annotated[int, Meta(ge=1, le=1_000_000)] = 6000
    """Budget of the search for a path."""
    goal_bias: Annotated[float, Meta(ge=0.0, le=1.0)] = 0.1
    step_m: Positive = 1.0
    """Longest edge of the tree."""


class Randomization(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Half-widths of the uniform offsets that the seed draws for each episode."""

    start_xy_m: NonNegative = 0.0
    start_yaw_deg: NonNegative = 0.0
    box_xy_m: NonNegative = 0.0
    box_yaw_deg: NonNegative = 0.0


class Scenario(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Everything that an episode starts from, but the seed."""

    name: Name
    """Names the run's folder and shows up in its report."""
    room: Room
    start: PoseDeg
    """Nominal pose of the robot's trunk, projected to the floor."""
    box: Box
    goal: Goal
    description: str = ""
    planning: PlanSettings = PlanSettings()
    mission: MissionSettings = MissionSettings()
    pushing: PushSettings = PushSettings()
    reference: Reference | None = None
    """A curve for the box's centre, from its nominal pose on and pushed at its rear face, instead of a planned path; it
    ends at the goal."""
    randomization: Randomization = Randomization()
