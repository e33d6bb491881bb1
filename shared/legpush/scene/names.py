"""Names that scenarios, messages and command lines share."""

from typing import Literal

PlannerName = Literal["rrt", "rrt_connect", "rrt_star", "informed_rrt_star", "bit_star", "prm_star"]
Steering = Literal["straight", "dubins", "reeds_shepp"]
BoxShape = Literal["cuboid", "cylinder", "wedge", "l_shape"]
Face = Literal["rear", "right", "front", "left"]
"""A face of a box, seen along its x axis."""
