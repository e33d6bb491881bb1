"""What a search comes to."""

from dataclasses import dataclass

from legpush.arrays import Floats
from legpush.geometry import Point2


@dataclass(frozen=True, kw_only=True)
class Route:
    """A path from the start, the tree that was grown for it, and whether the path ends at the goal."""

    reached: bool
    points_m: Floats
    """(n, 2), the start first; the start alone where nothing else was found."""
    curve: Floats | None
    """Of a path that is not straight between its points: x, y and yaw, dense, (k, 3)."""
    tree_points_m: tuple[Point2, ...]
    tree_parents: tuple[int, ...]
    """Node i hangs on node `tree_parents[i]`, a root on itself; parents come before their children."""
    n_iterations: int
