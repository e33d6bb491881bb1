"""What rooms are drawn from, apart from a seed."""

from dataclasses import dataclass

from legpush.errors import ConfigError


@dataclass(frozen=True, kw_only=True)
class RandomRoom:
    """What is drawn."""

    size_m: tuple[float, float] = (8.0, 8.0)
    """Extent of the room."""
    obstacles: int = 10
    """Rectangles that stand in it."""
    obstacle_m: tuple[float, float] = (0.2, 1.0)
    """Shortest and longest side of one."""
    corridor_m: float = 1.5
    """Everywhere on the way from start to box to goal there is a passage of this width."""
    push_m: float = 1.0
    """From the box to its goal, at least."""
    mass_kg: float = 0.1
    friction: float = 0.5
    box_xy_m: float = 0.05
    box_yaw_deg: float = 5.0
    """How far the box may be from where the map has it."""
    position_tolerance_m: float = 0.03
    angle_tolerance_deg: float = 3.0

    def __post_init__(self) -> None:
        """Refuse what cannot be drawn (`ConfigError`)."""
        low_m, high_m = self.obstacle_m
        if not 0.0 < low_m <= high_m:
            raise ConfigError(f"Expected 0 < shortest <= longest side of an obstacle, got {low_m} and {high_m}")
        if not 0.0 < self.corridor_m < min(self.size_m):
            raise ConfigError(
                f"Expected a corridor narrower than the room, {min(self.size_m)} m, got {self.corridor_m}"
            )
        if not 0 <= self.obstacles <= 1000:
            raise ConfigError(f"Expected 0 to 1000 obstacles, got {self.obstacles}")
