"""Result of a search for the trunk."""

from dataclasses import dataclass

from legpush.arrays import Floats
from legpush.geometry import Point2


@dataclass(frozen=True, kw_only=True)
class Route:
    """A path from the start, whether it ends at the goal, and the search tree."""

    reached: bool
    points_m: Floats
    """Corners of the path, (n, 2), the start first; only the start if the search found nothing."""
    curve: Floats | None
    """Dense poses x, y and yaw, (k, 3), of a path that is not straight between its points."""
    tree_points_m: tuple[Point2, ...]
    tree_parents: tuple[int, ...]
    """Index of each node's parent; a root is its own parent. Parents come before their children."""
    n_iterations: int
