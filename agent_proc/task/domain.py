"""What the episodes of a training draw: the box, the goal, and how far the starts are off."""

from math import atan2, cos, hypot, sin
from typing import Any, Final

import numpy as np
from msgspec import Struct
from msgspec.structs import asdict, replace

from legpush.bounds import BoxMass, Degrees, Distance, Friction, Length, Turn
from legpush.errors import ConfigError
from legpush.fields import require
from legpush.geometry import wrap_angle
from legpush.scene.scenario import PoseDeg, Scenario

Interval = tuple[float, float]
"""Lowest and highest value."""
POSITIVE: Final[dict[str, Any]] = {"mass_kg": BoxMass, "friction": Friction, "distance_m": Length}
ANGLES: Final[dict[str, Any]] = {"goal_bearing_deg": Degrees, "goal_yaw_deg": Degrees}
"""Type of the values of each interval of a `Domain`."""
OFFSETS: Final = ("start_xy_m", "start_yaw_deg", "box_xy_m", "box_yaw_deg")
"""Fields of a `Domain` that replace those of the scenario's `randomization`."""


class Domain(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What each episode of a training draws in place of what its scenario has; None keeps that of the scenario.

    Draws are uniform, except for the distance, whose logarithm is uniform: as many episodes between 0.1 and 0.2 m as
    between 0.5 and 1 m. Evaluations of a training are made in the scenario itself.
    """

    mass_kg: Interval | None = None
    """Of the box."""
    friction: Interval | None = None
    """Of the box."""
    distance_m: Interval | None = None
    """From the box's nominal place to its goal, in the direction of the scenario. The last pushes are the difficult
    ones, and short distances give more of them."""
    goal_bearing_deg: Interval | None = None
    """By how much that direction is turned about the box."""
    goal_yaw_deg: Interval | None = None
    """By how much the heading of the goal is turned."""
    start_xy_m: Distance | None = None
    """Largest offset of the robot from its nominal place along x and y, as in the scenario's `randomization`."""
    start_yaw_deg: Turn | None = None
    """The same of its heading."""
    box_xy_m: Distance | None = None
    """The same of the place of the box."""
    box_yaw_deg: Turn | None = None
    """The same of the heading of the box."""

    def __post_init__(self) -> None:
        """Check the intervals.

        Raises:
            ConfigError: One is empty, or reaches beyond what can be simulated.
        """
        for name, kind in {**POSITIVE, **ANGLES}.items():
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


def drawn_scenario(domain: Domain, scenario: Scenario, random: np.random.Generator) -> Scenario:
    """A scenario for the next episode."""
    drawn = {
        name: float(random.uniform(*interval))
        for name, interval in (("mass_kg", domain.mass_kg), ("friction", domain.friction))
        if interval is not None
    }
    scenario = replace(scenario, box=replace(scenario.box, **drawn))
    if domain.distance_m is not None:
        low, high = np.log(domain.distance_m)
        pose = _goal_at(scenario, float(np.exp(random.uniform(low, high))))
        scenario = replace(scenario, goal=replace(scenario.goal, pose=pose))
    if domain.goal_bearing_deg is not None:
        pose = _goal_turned(scenario, float(np.radians(random.uniform(*domain.goal_bearing_deg))))
        scenario = replace(scenario, goal=replace(scenario.goal, pose=pose))
    if domain.goal_yaw_deg is not None:
        pose = scenario.goal.pose
        yaw_rad = wrap_angle(pose.pose().yaw_rad + float(np.radians(random.uniform(*domain.goal_yaw_deg))))
        pose = replace(pose, yaw_deg=float(np.degrees(yaw_rad)))
        scenario = replace(scenario, goal=replace(scenario.goal, pose=pose))
    offsets = {name: value for name, value in asdict(domain).items() if name in OFFSETS and value is not None}
    return replace(scenario, randomization=replace(scenario.randomization, **offsets)) if offsets else scenario


def _goal_at(scenario: Scenario, distance_m: float) -> PoseDeg:
    """The goal pose, moved on the line from the box to the goal until its distance from the box is `distance_m`."""
    box, goal = scenario.box.pose, scenario.goal.pose
    share = distance_m / hypot(goal.x_m - box.x_m, goal.y_m - box.y_m)
    return replace(goal, x_m=box.x_m + share * (goal.x_m - box.x_m), y_m=box.y_m + share * (goal.y_m - box.y_m))


def _goal_turned(scenario: Scenario, bearing_rad: float) -> PoseDeg:
    """The goal pose, moved on the circle about the box."""
    box, goal = scenario.box.pose, scenario.goal.pose
    x_m, y_m = goal.x_m - box.x_m, goal.y_m - box.y_m
    angle_rad, radius_m = atan2(y_m, x_m) + bearing_rad, hypot(x_m, y_m)
    return replace(goal, x_m=box.x_m + radius_m * cos(angle_rad), y_m=box.y_m + radius_m * sin(angle_rad))
