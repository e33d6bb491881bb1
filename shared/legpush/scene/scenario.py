"""A scenario as one record: the room, the robot's start, the box and its goal pose. It travels in `Reset`."""

from math import radians
from typing import Annotated, Literal

from msgspec import Meta, Struct

from legpush.bounds import (
    LARGEST_LOAD,
    LEAST_THICKNESS_M,
    MAX_APPEARING,
    MAX_OBSTACLES,
    MAX_OVERLAP,
    MAX_TEXT,
    AngleTolerance,
    BoxMass,
    BoxOffset,
    BoxSide,
    CalibrationPushes,
    Coordinate,
    Degrees,
    Distance,
    Friction,
    Length,
    Margin,
    PushCycles,
    Reserve,
    Resolution,
    ShortIterations,
    Slope,
    TimeS,
    Unit,
)
from legpush.fields import Name
from legpush.geometry import Point3, Pose2
from legpush.realism.settings import Randomization, Realism
from legpush.scene.names import BoxShape, Face
from legpush.scene.overlap import deepest_overlap
from legpush.scene.plan_settings import PlanSettings
from legpush.scene.reference import Reference
from legpush.scene.robot import RobotSpec
from legpush.scene.solid import even_com_m, steps_to_surface


class Rectangle(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """An axis-aligned wall or block on the floor, world frame."""

    x_min_m: Coordinate
    x_max_m: Coordinate
    y_min_m: Coordinate
    y_max_m: Coordinate
    appears_at_s: TimeS = 0.0
    """0: it is there from the start. Otherwise it appears at this simulated time, or as soon after it as neither robot
    nor box is near its place."""

    def __post_init__(self) -> None:
        """Check that the rectangle is thick enough.

        Raises:
            ValueError: It is not.
        """
        for low, high in (("x_min_m", "x_max_m"), ("y_min_m", "y_max_m")):
            if not getattr(self, high) - getattr(self, low) >= LEAST_THICKNESS_M:
                raise ValueError(
                    f"Expected {low} < {high}, by at least {LEAST_THICKNESS_M:g} m, got {getattr(self, low)} and "
                    f"{getattr(self, high)}"
                )

    def sides_m(self) -> tuple[float, float, float, float]:
        """Return the least and the largest x, then the same of y."""
        return self.x_min_m, self.x_max_m, self.y_min_m, self.y_max_m


class PoseDeg(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A planar pose in metres and degrees, as people write it in a file, world frame."""

    x_m: Coordinate
    y_m: Coordinate
    yaw_deg: Degrees

    def pose(self) -> Pose2:
        """Return the same pose in radians."""
        return Pose2(x_m=self.x_m, y_m=self.y_m, yaw_rad=radians(self.yaw_deg))


class Room(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The floor from (0, 0) to `size_m`, with everything that stands on it; the area outside is occupied."""

    size_m: tuple[Length, Length]
    """Extent along x and y."""
    obstacles: Annotated[tuple[Rectangle, ...], Meta(max_length=MAX_OBSTACLES)] = ()
    resolution_m: Resolution = 0.05
    """Cell size of the occupancy map that the planner gets."""
    wall_height_m: Length = 0.6
    """Height of walls and blocks, in physics and in pictures."""
    slope_deg: Slope = 0.0
    """Inclination of the whole floor. The z axis of the world frame is the normal of the floor, so gravity is tilted,
    and roll and pitch are measured against the floor."""
    uphill_deg: Degrees = 0.0
    """The direction in which the floor rises, about z from the x axis of the world."""

    def __post_init__(self) -> None:
        """Check that the physics can carry the obstacles.

        Raises:
            ValueError: Too many of them share a place, or appear later.
        """
        n_later = sum(obstacle.appears_at_s > 0.0 for obstacle in self.obstacles)
        if n_later > MAX_APPEARING:
            raise ValueError(f"Expected at most {MAX_APPEARING} obstacles with appears_at_s, got {n_later}")
        n_over_one_another = deepest_overlap([obstacle.sides_m() for obstacle in self.obstacles])
        if n_over_one_another > MAX_OVERLAP:
            raise ValueError(
                f"Expected at most {MAX_OVERLAP} obstacles that overlap in one place, got {n_over_one_another}"
            )


class Box(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The box to be pushed."""

    pose: PoseDeg
    """Nominal pose of its centre; x points from the rear face to the front face."""
    size_m: tuple[BoxSide, BoxSide, BoxSide] = (0.4, 0.5, 0.4)
    """Length (x), width (y) and height of its bounding box."""
    shape: BoxShape = "cuboid"
    """The solid within that bounding box, of even density. `cuboid`: all of it. `cylinder`: an upright one. `wedge`:
    full height at the rear face, falling to the floor at the front. `l_shape`: without the front right quarter, seen
    from above."""
    mass_kg: BoxMass = 0.1
    friction: Friction = 0.5
    """Sliding friction coefficient with the floor."""
    foot_friction: Friction | None = None
    """Sliding friction coefficient with the feet and all other parts of the robot; without it, the same as with the
    floor."""
    com_offset_m: tuple[BoxOffset, BoxOffset, BoxOffset] = (0.0, 0.0, 0.0)
    """Where the centre of mass is, from where even density puts it, along the axes of the box. A small load at the
    surface, in this direction, is as heavy as that takes, and the rest of the box is of even density. The load has at
    most nine tenths of the mass."""

    def __post_init__(self) -> None:
        """Check that a cylinder is round, and that the centre of mass is within the solid.

        Raises:
            ValueError: It is not.
        """
        if self.shape == "cylinder" and self.size_m[0] != self.size_m[1]:
            raise ValueError(
                f"Expected equal length and width of a cylinder in size_m, got {self.size_m[0]} and {self.size_m[1]}"
            )
        if not self.load_share <= LARGEST_LOAD:
            raise ValueError(
                f"Expected com_offset_m at most {LARGEST_LOAD:g} of the way to the surface of the {self.shape} in that "
                f"direction, got {self.com_offset_m}, which is {self.load_share:.2f} of it"
            )

    @property
    def friction_with_robot(self) -> float:
        """Sliding friction coefficient with the feet and all other parts of the robot."""
        return self.friction if self.foot_friction is None else self.foot_friction

    @property
    def com_m(self) -> Point3:
        """Centre of mass in the frame of the box, whose origin is the middle of `size_m`."""
        x, y, z = (a + b for a, b in zip(even_com_m(self.shape, self.size_m), self.com_offset_m, strict=True))
        return x, y, z

    @property
    def load_share(self) -> float:
        """Share of the mass that the load has; 0 without an offset."""
        return 1.0 / steps_to_surface(self.shape, self.size_m, self.com_offset_m)


class Goal(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The pose that the box must reach for the mission to succeed, and the tolerances."""

    pose: PoseDeg
    position_tolerance_m: Length = 0.03
    angle_tolerance_deg: AngleTolerance = 3.0


class MissionSettings(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Settings of the mission (Fig. 5)."""

    handover_distance_m: Length = 3.0
    """Distance from trunk to box at which walking hands over to pushing."""
    max_push_cycles: PushCycles | None = None
    """The mission fails after this many push cycles. Without it, the number follows from the length of the box's path
    and from how far one push moves this box; an episode of an evaluation has 200."""


class PushSettings(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Settings of the pushes, and of the queries for paths of the box."""

    composition: Literal["closed_loop", "open_loop"] = "closed_loop"
    """`closed_loop`: each push is chosen from the measured pose of the box. `open_loop`: all pushes are chosen before
    the first one."""
    calibration_pushes: CalibrationPushes = 0
    """How many pushes, straight ahead with both legs in turn, measure an unknown box before its path is planned."""
    faces: Annotated[tuple[Face, ...], Meta(min_length=1, max_length=4)] = ("rear", "right", "front", "left")
    """Faces that may be pushed."""
    turning_reserve: Reserve = 1.4
    """Least turning radius of a planned path, as a multiple of the radius at which the box turns when only one foot
    pushes it. A value above 1 leaves room for corrections."""
    margin_m: Margin = 0.07
    """Clearance that box and robot keep."""
    run_in_m: Distance = 0.4
    """Length of the straight stretch before the goal."""
    face_change_m: Distance | None = None
    """Cost of a walk around the box, as a length of pushing. If not given, that by which pushes move this very box
    while the robot walks: then paths of the box cost seconds."""
    docking_m: Distance = 0.35
    """How near to its goal the box is docked: pushed by whatever short sequence of pushes and walks brings it there,
    instead of along a path. 0: never."""
    max_iterations: ShortIterations = 12_000
    """Budget of the search for a path."""
    goal_bias: Unit = 0.1
    """Probability that a sample is the goal."""
    step_m: Length = 1.0
    """Longest edge of the tree."""


class Scenario(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Everything that an episode starts from, except the seed."""

    name: Name
    """Used in the name of the run's folder and in its report."""
    room: Room
    start: PoseDeg
    """Nominal pose of the robot's trunk, projected on the floor."""
    box: Box
    goal: Goal
    description: Annotated[str, Meta(max_length=MAX_TEXT)] = ""
    """One line for `legpush scenarios list`."""
    planning: PlanSettings = PlanSettings()
    mission: MissionSettings = MissionSettings()
    pushing: PushSettings = PushSettings()
    reference: Reference | None = None
    """A curve that the centre of the box follows instead of a planned path. It begins at the nominal pose of the box
    and ends at the goal; the box is pushed at its rear face."""
    randomization: Randomization = Randomization()
    robot: RobotSpec = RobotSpec()
    """The robot. A file states only the numbers that differ from the defaults, as in `[robot.gait]`."""
    realism: Realism = Realism()
    """What planner, control and agent are not told, and how they perceive robot and box."""
