"""A push that is drawn before the room is: what makes a random room solvable."""

from collections.abc import Iterator
from dataclasses import dataclass
from math import cos, pi, sin
from typing import Final

import numpy as np

from legpush.faces import FACES, pushed_box, pushed_pose
from legpush.geometry import Pose2
from legpush.robot import BODY_LENGTH_M, BODY_WIDTH_M
from legpush.room_shapes import Footprint, behind_box, box_footprint
from legpush.scenario import STAND_OFF_M, STATION_M, Box, Face

MAX_STAGES: Final = 3
LENGTH_M: Final = (0.5, 3.0)
"""Of a stage."""
RADIUS_M: Final = 1.6
"""Of an arc: what the box can be pushed along at any face."""
STRAIGHT_SHARE: Final = 0.5
"""Of the stages; the others are arcs to the left or to the right."""
STEP_M: Final = 0.1


@dataclass(frozen=True, kw_only=True)
class Stage:
    """Poses of the box, `STEP_M` apart, pushed at one face."""

    face: Face
    poses: tuple[Pose2, ...]


@dataclass(frozen=True, kw_only=True)
class DrawnPush:
    """Stage after stage, from the box's place to its goal."""

    box: Box
    stages: tuple[Stage, ...]

    def footprints(self) -> Iterator[Footprint]:
        """All that box and robot cover on the way."""
        for stage in self.stages:
            box = pushed_box(self.box, stage.face)
            for pose in stage.poses:
                pushed = pushed_pose(pose, stage.face)
                yield box_footprint(box, pushed)
                yield Footprint(pose=behind_box(box, pushed, STATION_M), length_m=BODY_LENGTH_M, width_m=BODY_WIDTH_M)

    def stand_off(self, stage: Stage, pose: Pose2) -> Pose2:
        """Where the robot comes from to push the stage's face of the box at a pose, and where it leaves to."""
        return behind_box(pushed_box(self.box, stage.face), pushed_pose(pose, stage.face), STAND_OFF_M)


def draw_push(size_m: tuple[float, float], box: Box, random: np.random.Generator) -> DrawnPush:
    """From anywhere in the room; it may lead out of it."""
    x_m, y_m = (float(random.uniform(0.0, side)) for side in size_m)
    pose = Pose2(x_m=round(x_m, 3), y_m=round(y_m, 3), yaw_rad=float(random.uniform(-pi, pi)))
    stages: list[Stage] = []
    for _ in range(int(random.integers(1, MAX_STAGES + 1))):
        present = stages[-1].face if stages else None
        others = [face for face in FACES if face != present]
        face = others[int(random.integers(len(others)))]
        turn = 0.0 if random.random() < STRAIGHT_SHARE else float(random.choice([-1.0, 1.0]))
        stages.append(_stage(face, pose, turn / RADIUS_M, float(random.uniform(*LENGTH_M))))
        pose = stages[-1].poses[-1]
    return DrawnPush(box=box, stages=tuple(stages))


def _stage(face: Face, begin: Pose2, curvature_per_m: float, length_m: float) -> Stage:
    pushed = pushed_pose(begin, face)
    back = pushed_pose(Pose2(x_m=0.0, y_m=0.0, yaw_rad=0.0), face).inverse()
    n_steps = max(1, round(length_m / STEP_M))
    poses = []
    for k in range(n_steps + 1):
        angle_rad = curvature_per_m * length_m * k / n_steps
        if curvature_per_m:
            ahead = Pose2(
                x_m=sin(angle_rad) / curvature_per_m, y_m=(1.0 - cos(angle_rad)) / curvature_per_m, yaw_rad=angle_rad
            )
        else:
            ahead = Pose2(x_m=length_m * k / n_steps, y_m=0.0, yaw_rad=0.0)
        poses.append(pushed @ ahead @ back)
    return Stage(face=face, poses=tuple(poses))
