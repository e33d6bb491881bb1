"""Parameters of rooms that are drawn at random."""

from dataclasses import dataclass
from typing import Annotated, Final

from legpush.arguments import arg
from legpush.bounds import AngleTolerance, BoxMass, Friction, Length
from legpush.errors import ConfigError
from legpush.fields import require

MOST_SIZE_M: Final = 200.0


@dataclass(frozen=True, kw_only=True)
class RandomRoom:
    """Parameters of a random room, apart from its seed."""

    size_m: Annotated[tuple[float, float], arg("X Y")] = (8.0, 8.0)
    """Extent of the room along x and y."""
    obstacles: Annotated[int, arg("N")] = 10
    """Number of rectangles in the room."""
    obstacle_m: Annotated[tuple[float, float], arg("LOW HIGH")] = (0.2, 1.0)
    """Shortest and longest side of a rectangle."""
    corridor_m: Annotated[float, arg("M")] = 1.5
    """Least width of the passage from start to box to goal."""
    push_m: Annotated[float, arg("M")] = 1.0
    """Least distance from the box to its goal."""
    mass_kg: Annotated[float, arg("KG")] = 0.1
    """Mass of the box."""
    friction: Annotated[float, arg("MU")] = 0.5
    """Friction of the box."""
    box_xy_m: Annotated[float, arg("M")] = 0.05
    """Largest offset of the box from its place in the scenario, along x and along y."""
    box_yaw_deg: Annotated[float, arg("DEG")] = 5.0
    """Largest turn of the box from its heading in the scenario."""
    position_tolerance_m: Annotated[float, arg("M")] = 0.03
    """Position tolerance of the goal."""
    angle_tolerance_deg: Annotated[float, arg("DEG")] = 3.0
    """Angle tolerance of the goal."""

    def __post_init__(self) -> None:
        """Check that such a room can be drawn.

        Raises:
            ConfigError: A parameter is out of range.
        """
        for name, most in (("size_m", MOST_SIZE_M), ("obstacle_m", MOST_SIZE_M), ("corridor_m", MOST_SIZE_M)):
            values = getattr(self, name)
            for value in values if isinstance(values, tuple) else (values,):
                if not 0.0 < value <= most:
                    raise ConfigError(f"Expected more than 0 and at most {most:g} m for {name}, got {value}")
        for name in ("push_m", "box_xy_m", "box_yaw_deg"):
            if not 0.0 <= getattr(self, name) <= MOST_SIZE_M:
                raise ConfigError(f"Expected 0 to {MOST_SIZE_M:g} for {name}, got {getattr(self, name)}")
        for name, kind in (
            ("mass_kg", BoxMass),
            ("friction", Friction),
            ("position_tolerance_m", Length),
            ("angle_tolerance_deg", AngleTolerance),
        ):
            require(kind, getattr(self, name), name)
        low_m, high_m = self.obstacle_m
        if not 0.0 < low_m <= high_m:
            raise ConfigError(f"Expected 0 < shortest <= longest side of an obstacle, got {low_m} and {high_m}")
        if not 0.0 < self.corridor_m < min(self.size_m):
            raise ConfigError(
                f"Expected a corridor narrower than the room, {min(self.size_m)} m, got {self.corridor_m}"
            )
        if not 0 <= self.obstacles <= 1000:
            raise ConfigError(f"Expected 0 to 1000 obstacles, got {self.obstacles}")
