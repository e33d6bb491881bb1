"""Where the centre of mass of a box's solid is, and how far it is from there to the surface.

Points are in the frame of the box, whose origin is the centre of its bounding box.
"""

from math import hypot, inf

from legpush.geometry import Point3
from legpush.scene.names import BoxShape


def even_com_m(shape: BoxShape, size_m: Point3) -> Point3:
    """Return the centre of mass of a solid of even density."""
    length, width, height = size_m
    match shape:
        case "wedge":
            return -length / 6, 0.0, -height / 6
        case "l_shape":
            return -length / 12, width / 12, 0.0
        case _:
            return 0.0, 0.0, 0.0


def steps_to_surface(shape: BoxShape, size_m: Point3, step_m: Point3) -> float:
    """Return how many steps lead from the centre of mass of even density to the surface; infinity for a step of zero.

    The number need not be whole. The way is straight.
    """
    start = even_com_m(shape, size_m)
    (x, y, z), (dx, dy, dz) = start, step_m
    within = min(_steps_to(side / 2, at, step) for side, at, step in zip(size_m, start, step_m, strict=True))
    length, _, height = size_m
    match shape:
        case "cylinder":
            across = hypot(dx, dy)
            return min(_steps_to(length / 2, 0.0, across), within)
        case "wedge":
            slope = dx / length + dz / height
            return min(-(x / length + z / height) / slope, within) if slope > 0.0 else within
        case "l_shape" if dx > 0.0 > dy:
            return min(max(-x / dx, -y / dy), within)
        case _:
            return within


def _steps_to(half_m: float, at_m: float, step_m: float) -> float:
    """Return how many steps lead along an axis to the side ahead of a solid from -`half_m` to `half_m`."""
    if step_m == 0.0:
        return inf
    return (half_m - at_m) / step_m if step_m > 0.0 else (-half_m - at_m) / step_m
