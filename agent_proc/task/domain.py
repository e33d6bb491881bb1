"""What the episodes of a training draw: the box, the goal, the floor, and how far the starts are off."""

from typing import Annotated, Any, Final

from msgspec import Meta, Struct

from legpush.bounds import BoxMass, BoxOffset, BoxSide, Degrees, Distance, Friction, Length, Slope, Turn
from legpush.errors import ConfigError
from legpush.fields import require
from legpush.scene.names import BoxShape

Interval = tuple[float, float]
"""Lowest and highest value."""
Shapes = Annotated[tuple[BoxShape, ...], Meta(min_length=1)]
POSITIVE: Final[dict[str, Any]] = {"mass_kg": BoxMass, "friction": Friction, "side_m": BoxSide, "distance_m": Length}
OTHERS: Final[dict[str, Any]] = {
    "com_offset_m": BoxOffset,
    "goal_bearing_deg": Degrees,
    "goal_yaw_deg": Degrees,
    "slope_deg": Slope,
    "uphill_deg": Degrees,
}
"""Type of the values of each interval of a `Domain`."""
OFFSETS: Final = ("start_xy_m", "start_yaw_deg", "box_xy_m", "box_yaw_deg")
"""Fields of a `Domain` that replace those of the scenario's `randomization`."""


class Domain(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What each episode of a training draws in place of what its scenario has; None keeps that of the scenario.

    Draws are uniform and independent, except for the distance, whose logarithm is uniform: as many episodes between 0.1
    and 0.2 m as between 0.5 and 1 m. The robot stands ready behind the box that is drawn.
    """

    mass_kg: Interval | None = None
    """Mass of the box."""
    friction: Interval | None = None
    """Friction of the box with the floor."""
    shape: Shapes | None = None
    """Shapes of the box, as likely as each other. A cylinder is as wide as it is long."""
    side_m: Interval | None = None
    """Length and width of the box."""
    com_offset_m: Interval | None = None
    """How far the centre of mass is off, along the length of the box and along its width. What the shape cannot have is
    drawn again."""
    distance_m: Interval | None = None
    """Distance from the box's nominal place to its goal, in the direction of the scenario. The last pushes are the
    difficult ones, and short distances give more of them."""
    goal_bearing_deg: Interval | None = None
    """Angle by which the direction from the box to its goal is turned about the box."""
    goal_yaw_deg: Interval | None = None
    """Angle by which the heading of the goal is turned."""
    slope_deg: Interval | None = None
    """Inclination of the floor."""
    uphill_deg: Interval | None = None
    """Direction in which the floor rises."""
    start_xy_m: Distance | None = None
    """Largest offset of the robot from its nominal place along x and y, as in the scenario's `randomization`."""
    start_yaw_deg: Turn | None = None
    """Largest offset of the robot's heading."""
    box_xy_m: Distance | None = None
    """Largest offset of the box from its nominal place along x and y."""
    box_yaw_deg: Turn | None = None
    """Largest offset of the box's heading."""

    def __post_init__(self) -> None:
        """Check the intervals.

        Raises:
            ConfigError: One is empty, or reaches beyond what can be simulated.
        """
        for name, kind in {**POSITIVE, **OTHERS}.items():
            interval = getattr(self, name)
            if interval is None:
                continue
            low, high = interval
            if not low <= high or (name in POSITIVE and not low > 0.0):
                zero = "0 < " if name in POSITIVE else ""
                raise ConfigError(f"Expected {zero}low <= high for {name} of the domain, got {interval}")
            for value in interval:
                require(kind, value, f"{name} of the domain")


DOMAIN_FIELDS: Final = Domain.__struct_fields__
