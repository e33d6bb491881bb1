"""Draws the scenario of an episode from the domain of a task."""

from math import atan2, cos, hypot, sin
from typing import Final

import numpy as np
from msgspec.structs import asdict, replace

from agent_proc.task.config import TaskConfig
from agent_proc.task.domain import OFFSETS, Domain
from agent_proc.task.rooms import refuse_missions
from legpush.errors import ConfigError
from legpush.geometry import wrap_angle
from legpush.scene.scenario import Box, PoseDeg, Scenario
from legpush.scene.station import station

MOST_DRAWS: Final = 100
"""Draws of an offset of the centre of mass before the box counts as one that cannot have it."""


def scenario_of_start(task: TaskConfig, seed: int) -> Scenario:
    """Return what the seed of a start draws from the domain of a task; an episode has the steps of the task at most.

    Raises:
        ConfigError: The drawn box cannot be made, or an episode of the task is a whole mission.
    """
    refuse_missions(task.random_room)
    drawn = drawn_scenario(task.domain, task.scenario, np.random.default_rng(seed))
    if drawn.mission.max_push_cycles is not None:
        return drawn
    return replace(drawn, mission=replace(drawn.mission, max_push_cycles=task.max_steps))


def drawn_scenario(domain: Domain, scenario: Scenario, random: np.random.Generator) -> Scenario:
    """Return a scenario for the next episode.

    Raises:
        ConfigError: No drawn box can have the offset of its centre of mass.
    """
    box = _drawn_box(domain, scenario.box, random)
    if box.size_m != scenario.box.size_m:
        place = station(scenario.robot, box, box.pose.pose())
        start = PoseDeg(x_m=place.x_m, y_m=place.y_m, yaw_deg=box.pose.yaw_deg)
        scenario = replace(scenario, start=start)
    scenario = replace(scenario, box=box)
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
    for name, interval in (("slope_deg", domain.slope_deg), ("uphill_deg", domain.uphill_deg)):
        if interval is not None:
            scenario = replace(scenario, room=replace(scenario.room, **{name: float(random.uniform(*interval))}))
    offsets = {name: value for name, value in asdict(domain).items() if name in OFFSETS and value is not None}
    return replace(scenario, randomization=replace(scenario.randomization, **offsets)) if offsets else scenario


def _drawn_box(domain: Domain, box: Box, random: np.random.Generator) -> Box:
    drawn = {
        name: float(random.uniform(*interval))
        for name, interval in (("mass_kg", domain.mass_kg), ("friction", domain.friction))
        if interval is not None
    }
    box = replace(box, **drawn)
    shape = box.shape if domain.shape is None else domain.shape[int(random.integers(len(domain.shape)))]
    size_m = box.size_m
    if domain.side_m is not None:
        length_m, width_m = random.uniform(*domain.side_m, 2).tolist()
        size_m = (length_m, width_m, size_m[2])
    if shape == "cylinder":
        size_m = (size_m[0], size_m[0], size_m[2])
    for _ in range(MOST_DRAWS if domain.com_offset_m else 1):
        offset_m = box.com_offset_m
        if domain.com_offset_m is not None:
            x_m, y_m = random.uniform(*domain.com_offset_m, 2).tolist()
            offset_m = (x_m, y_m, offset_m[2])
        try:
            return replace(box, shape=shape, size_m=size_m, com_offset_m=offset_m)
        except ValueError as error:
            fault = error
    raise ConfigError(f"Expected a domain with boxes that can be made, got none in {MOST_DRAWS} draws ({fault})")


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
