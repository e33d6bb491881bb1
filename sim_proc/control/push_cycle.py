"""The push cycle.

A front foot moves along a Bezier curve into the box and back. Then every foot steps to its marker at the box: its
corner of the foot rectangle of a robot that stands ready for the next push.
"""

from dataclasses import dataclass
from math import hypot, sqrt
from typing import Final

import numpy as np

from legpush.arrays import Floats
from legpush.errors import MotionError
from legpush.geometry import Pose2
from legpush.messages.stepping import Push
from legpush.scene.faces import PUSHABLE, pushed_box, pushed_pose
from legpush.scene.footprints import behind_box
from legpush.scene.names import Face
from legpush.scene.robot import FOOT_RADIUS_M, LEGS, FrontLeg, Leg, foot_rectangle_b
from legpush.scene.scenario import STATION_M, Box
from sim_proc.control.gait import MAX_OFF_M, MAX_OFF_RAD, TOUCHDOWN_M, require_within_reach, rest, swing_to
from sim_proc.control.plant import TickLog
from sim_proc.control.steps import Step, Steps, Swing
from sim_proc.control.swing import bezier, control_points, gentle_stop, parabola

PUSH_SHIFT_TICKS: Final = 14
PUSH_TICKS: Final = 48
RETURN_TICKS: Final = 16
RESTEP_SHIFT_TICKS: Final = 8
RESTEP_SWING_TICKS: Final = 11
PUSH_MARGIN_M: Final = 0.06
CONTACT_HEIGHT_SHARE: Final = 0.5
CONTACT_SIDE_SHARE: Final = 0.3
"""Contact point on the pushed face: share of the box's height, and of its width to the left (FL) or right (FR)."""

RESTEP_ORDER: Final[dict[FrontLeg, tuple[Leg, Leg, Leg]]] = {"FL": ("RR", "FR", "RL"), "FR": ("RL", "FL", "RR")}
"""Legs that step after the pushing one: the lateral sequence of the crawl, mirrored for the right side."""


def contact_point(pose: Pose2, box: Box, leg: FrontLeg, depth_m: float) -> Floats:
    """Where the centre of the foot ends, (3,), so that its surface is `depth_m` beyond the pushed face.

    `pose` is the frame of the box in which its pushed face is the rear one, and `box` has the size in that frame.
    """
    length, width, height = box.size_m
    side = CONTACT_SIDE_SHARE * width * (1 if leg == "FL" else -1)
    rear = -sqrt(length**2 / 4 - side**2) if box.shape == "cylinder" else -length / 2
    x, y = pose.apply([[rear + depth_m - FOOT_RADIUS_M, side]])[0]
    return np.array([x, y, CONTACT_HEIGHT_SHARE * height])


@dataclass(frozen=True, kw_only=True)
class PushLog:
    """Logs of a push cycle and the largest force of the box on the pushing foot."""

    logs: list[TickLog]
    peak_force_n: float


class Pusher:
    """Carries out push cycles."""

    def __init__(self, steps: Steps, box: Box) -> None:
        """Push `box` with the robot that takes `steps`."""
        self._steps = steps
        self._box = box

    def cycle(self, push: Push) -> PushLog:
        """Push, return the foot, and step to the box. Stop early at a fall.

        Raises:
            MotionError: The face cannot be pushed, or the robot does not stand at it.
        """
        posture = self._steps.posture
        plant = posture.plant
        leg = LEGS.index(push.leg)
        self._require_face(push.face)
        box, pose = pushed_box(self._box, push.face), pushed_pose(plant.box_pose(), push.face)
        require_within_reach("the place to push from", plant.trunk_pose(), behind_box(box, pose, STATION_M))
        expected = Pose2(x_m=push.depth_m, y_m=0.0, yaw_rad=0.0)
        goal = contact_point(pose, box, push.leg, push.depth_m)
        here = posture.feet_m[:, :2].mean(axis=0)
        ahead = [
            self._push_step(push.leg, here, posture.yaw_rad),
            *self._return_steps(push.leg, behind_box(box, pose @ expected, STATION_M))[:2],
        ]
        logs = [self._steps.take_step(ahead, self._bezier_swing(push, goal), lands=False)]
        peak = float(np.linalg.norm(logs[0].box_forces_n[:, leg], axis=1).max())
        if not plant.fallen:
            follow = self._return_steps(push.leg, self._next_station(push.face))
            for index, step in enumerate(follow[:-1]):
                ticks = step.swing_ticks
                swing = self._return_swing(step.target_m) if index == 0 else swing_to(step.target_m, ticks)
                logs.append(self._steps.take_step(follow[index : index + 4], swing))
                if plant.fallen:
                    break
        return PushLog(logs=logs, peak_force_n=peak)

    def _require_face(self, face: Face) -> None:
        if face not in PUSHABLE[self._box.shape]:
            valid = ", ".join(PUSHABLE[self._box.shape])
            raise MotionError(f"Expected a face that a {self._box.shape} can be pushed at ({valid}), got {face}")

    def _next_station(self, face: Face) -> Pose2:
        """Where to stand after the push: at the box, or in the same place if the box slid out of reach."""
        plant = self._steps.posture.plant
        here = plant.trunk_pose()
        station = behind_box(pushed_box(self._box, face), pushed_pose(plant.box_pose(), face), STATION_M)
        away = here.inverse() @ station
        near = hypot(away.x_m, away.y_m) <= MAX_OFF_M and abs(away.yaw_rad) <= MAX_OFF_RAD
        return station if near else here

    def _push_step(self, leg: FrontLeg, here: Floats, yaw_rad: float) -> Step:
        return Step(
            leg=leg,
            shift_ticks=PUSH_SHIFT_TICKS,
            swing_ticks=PUSH_TICKS,
            target_m=self._steps.posture.feet_m[LEGS.index(leg), :2].copy(),
            nominal_xy_m=here,
            end_velocity_m_s=np.zeros(2),
            end_yaw_rad=yaw_rad,
            margin_m=PUSH_MARGIN_M,
        )

    def _return_steps(self, pushing: FrontLeg, to: Pose2) -> list[Step]:
        """The pushing leg to its marker, then the other three, then rest. The trunk moves evenly from step to step."""
        posture = self._steps.posture
        markers = to.apply(foot_rectangle_b())
        here = posture.feet_m[:, :2].mean(axis=0)
        legs: list[Leg] = [pushing, *RESTEP_ORDER[pushing]]
        turn = Pose2(x_m=0.0, y_m=0.0, yaw_rad=posture.yaw_rad).inverse() @ Pose2(x_m=0.0, y_m=0.0, yaw_rad=to.yaw_rad)
        steps = []
        for place, leg in enumerate(legs):
            share = (place + 0.5) / len(legs)
            steps.append(
                Step(
                    leg=leg,
                    shift_ticks=0 if place == 0 else RESTEP_SHIFT_TICKS,
                    swing_ticks=RETURN_TICKS if place == 0 else RESTEP_SWING_TICKS,
                    target_m=markers[LEGS.index(leg)],
                    nominal_xy_m=here + share * (to.xy() - here),
                    end_velocity_m_s=np.zeros(2),
                    end_yaw_rad=posture.yaw_rad + turn.yaw_rad * (place + 1) / len(legs),
                    margin_m=PUSH_MARGIN_M,
                )
            )
        return [*steps, rest(to.xy(), to.yaw_rad)]

    @staticmethod
    def _bezier_swing(push: Push, goal_m: Floats) -> Swing:
        def curve(start_m: Floats) -> Floats:
            points = control_points(start_m, goal_m, push.w1, push.w2, push.locus, FOOT_RADIUS_M)
            return bezier(points, gentle_stop(PUSH_TICKS))

        return curve

    @staticmethod
    def _return_swing(target_m: Floats) -> Swing:
        """A swing straight from the box down to the marker."""

        def curve(start_m: Floats) -> Floats:
            return parabola(start_m, [*target_m, TOUCHDOWN_M], 0.0, RETURN_TICKS)

        return curve
