"""Obstacles that appear in the way of the box, or of the robot behind it."""

import numpy as np

from agent_proc.pushing.stage import Stage
from agent_proc.walking.obstacles import LOOK_STEP_M
from legpush.scene.faces import pushed_box
from legpush.scene.footprints import box_footprint, distance_m, obstacle_footprint, robot_footprint
from legpush.scene.scenario import Rectangle, Scenario
from legpush.scene.station import station


def is_in_push(obstacle: Rectangle, scenario: Scenario, path: Stage, from_m: float = 0.0) -> bool:
    """Whether an obstacle is nearer than `pushing.margin_m` to box or robot on what is left of a stage."""
    place, box, margin_m = obstacle_footprint(obstacle), pushed_box(scenario.box, path.face), scenario.pushing.margin_m
    for at_m in np.append(np.arange(from_m, path.length_m, LOOK_STEP_M), path.length_m).tolist():
        pose = path.pose(at_m)
        robot = robot_footprint(scenario.robot, station(scenario.robot, box, pose))
        if min(distance_m(place, box_footprint(box, pose)), distance_m(place, robot)) < margin_m:
            return True
    return False
