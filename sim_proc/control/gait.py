"""Walks along a path in a static crawl, one gait cycle of four steps at a time."""

from collections.abc import Sequence
from dataclasses import replace
from math import degrees, hypot, radians
from typing import Final

import numpy as np

from legpush.arrays import Floats
from legpush.errors import MotionError
from legpush.geometry import Pose2
from legpush.messages.stepping import PathProgress
from legpush.scene.robot import CONTROL_PERIOD_S, FOOT_RADIUS_M, LEGS
from sim_proc.control.footsteps import GAIT_ORDER, CycleTargets, PosePath, next_cycle
from sim_proc.control.plant import TickLog
from sim_proc.control.steps import Step, Steps, Swing
from sim_proc.control.swing import parabola

SHIFT_TICKS: Final = 6
SWING_TICKS: Final = 13
"""Durations of a step: the shift of the weight, then the swing of the leg."""
FIRST_SHIFT_TICKS: Final = 16
"""Shift before the first step of a path. A quicker start from standing would unload a standing foot."""
SETTLE_TICKS: Final = 24
"""Time after the last step to bring the weight back to the middle."""
STEP_HEIGHT_M: Final = 0.05
WALK_MARGIN_M: Final = 0.055
MAX_OFF_M: Final = 0.35
MAX_OFF_RAD: Final = radians(45.0)
"""Largest distance and turn from the trunk to the start of a path, or to the place to push from.

The first steps to a place farther away would be out of reach.
"""
TOUCHDOWN_M: Final = FOOT_RADIUS_M - 0.001
"""Commanded height of the centre of a landing foot, which is pressed a little into the floor."""


class PathWalk:
    """A walk along one path, cycle by cycle."""

    def __init__(self, steps: Steps, waypoints: Sequence[Pose2]) -> None:
        """Begin the path where the robot stands or walks.

        Raises:
            MotionError: The path begins too far from the robot.
        """
        require_within_reach("a path that begins", steps.posture.plant.trunk_pose(), waypoints[0])
        self._steps = steps
        self._path = PosePath(waypoints)
        self._travelled = np.zeros(4)

    def progress(self) -> PathProgress:
        """Travelled length of the feet. A turn on the spot counts by the arc that the feet describe."""
        done = bool((self._travelled >= self._path.length_m).all())
        return PathProgress(travelled_m=float(self._travelled.mean()), length_m=self._path.length_m, done=done)

    def cycle(self) -> list[TickLog]:
        """Take one step with each leg, and come to rest after the last cycle of the path. Stop early at a fall."""
        posture = self._steps.posture
        feet = posture.feet_m[:, :2]
        this = next_cycle(self._path, self._travelled, feet)
        following = next_cycle(self._path, this.travelled_m, this.feet_m)
        ahead = self._steps_of(self._travelled, this) + self._steps_of(this.travelled_m, following)
        if not self._travelled.any():
            ahead[0] = replace(ahead[0], shift_ticks=FIRST_SHIFT_TICKS)
        logs = []
        for index in range(len(GAIT_ORDER)):
            logs.append(self._steps.take_step(ahead[index : index + 4], swing_to(ahead[index].target_m, SWING_TICKS)))
            if posture.plant.fallen:
                return logs
        self._travelled = this.travelled_m
        if self.progress().done:
            logs.append(self._steps.take_step([self._rest()], None))
            posture.com_state[1:] = 0.0
        return logs

    def _steps_of(self, before: Floats, targets: CycleTargets) -> list[Step]:
        """The four steps of a cycle, during which the trunk advances evenly."""
        start, end = float(before.mean()), float(targets.travelled_m.mean())
        n_legs = len(GAIT_ORDER)
        duration = n_legs * (SHIFT_TICKS + SWING_TICKS) * CONTROL_PERIOD_S
        swing_share = 1 - SWING_TICKS / (2 * (SHIFT_TICKS + SWING_TICKS))
        steps = []
        for place, leg in enumerate(GAIT_ORDER):
            middle, finish = (start + (end - start) * (place + share) / n_legs for share in (swing_share, 1.0))
            near = self._path.poses(np.array([finish - 0.01, finish + 0.01]))
            steps.append(
                Step(
                    leg=leg,
                    shift_ticks=SHIFT_TICKS,
                    swing_ticks=SWING_TICKS,
                    target_m=targets.feet_m[LEGS.index(leg)],
                    nominal_xy_m=self._path.poses(np.array(middle))[:2],
                    end_velocity_m_s=(near[1, :2] - near[0, :2]) / 0.02 * (end - start) / duration,
                    end_yaw_rad=float(self._path.poses(np.array(finish))[2]),
                    margin_m=WALK_MARGIN_M,
                )
            )
        return steps

    def _rest(self) -> Step:
        end = self._path.poses(np.array(self._path.length_m))
        return rest(end[:2], float(end[2]))


def require_within_reach(what: str, trunk: Pose2, place: Pose2) -> None:
    """Check that the trunk is near enough to `place` for the feet to step there; `what` names it in the error.

    Raises:
        MotionError: The place is too far away, or turned too much.
    """
    away = trunk.inverse() @ place
    distance_m, turn_rad = hypot(away.x_m, away.y_m), abs(away.yaw_rad)
    if distance_m > MAX_OFF_M or turn_rad > MAX_OFF_RAD:
        raise MotionError(
            f"Expected {what} at most {MAX_OFF_M:g} m and {degrees(MAX_OFF_RAD):.0f}° from the trunk, "
            f"got {distance_m:.2f} m and {degrees(turn_rad):.0f}°"
        )


def rest(nominal_xy_m: Floats, yaw_rad: float) -> Step:
    """A step that keeps all feet down and brings the centre of mass to `nominal_xy_m`."""
    return Step(
        leg=None,
        shift_ticks=SETTLE_TICKS // 2,
        swing_ticks=SETTLE_TICKS // 2,
        target_m=nominal_xy_m,
        nominal_xy_m=nominal_xy_m,
        end_velocity_m_s=np.zeros(2),
        end_yaw_rad=yaw_rad,
        margin_m=0.0,
    )


def swing_to(target_m: Floats, n_ticks: int) -> Swing:
    """A parabolic swing that lands at `target_m` (2,)."""
    return lambda start_m: parabola(start_m, [*target_m, TOUCHDOWN_M], STEP_HEIGHT_M, n_ticks)
