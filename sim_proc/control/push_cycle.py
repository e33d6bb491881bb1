"""The push cycle.

A front foot moves along a Bezier curve into the box and back. Then every foot steps to its marker at the box: its
corner of the foot rectangle of a robot that stands ready for the next push.

A heavy box is pushed more slowly along the same curve, and the force that it takes is fed forward to all feet.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import cos, hypot, radians, sin, sqrt
from typing import Final

import numpy as np

from legpush.arrays import Floats
from legpush.errors import MotionError
from legpush.geometry import Pose2
from legpush.messages.stepping import Push
from legpush.scene.conventions import LEGS, FrontLeg, Leg
from legpush.scene.faces import PUSHABLE, pushed_box, pushed_pose
from legpush.scene.footprints import behind_box
from legpush.scene.names import Face
from legpush.scene.pushing.bounds import contact_height_m
from legpush.scene.robot import RobotSpec
from legpush.scene.scenario import Box
from sim_proc.control.gait import PathWalk, in_world, require_within_reach, swing_to
from sim_proc.control.plant import TickLog
from sim_proc.control.push_force import PushForce
from sim_proc.control.resistance import Resistance
from sim_proc.control.step import Step, Swing, rest
from sim_proc.control.steps import Steps
from sim_proc.control.stroke import heavy_force, heavy_ticks, heavy_way
from sim_proc.control.swing import bezier, control_points, gentle_stop, landing_swing
from sim_proc.gravity import GRAVITY_M_S2

RESTEP_ORDER: Final[dict[FrontLeg, tuple[Leg, Leg, Leg]]] = {"FL": ("RR", "FR", "RL"), "FR": ("RL", "FL", "RR")}
"""Legs that step after the pushing one: the lateral sequence of the crawl, mirrored for the right side."""
MIRRORED: Final = np.array([1.0, -1.0, 1.0])
"""Signs by which a vector becomes its mirror image."""
ON_ITS_WAY_RADII: Final = 2.5
"""A folded leg may pass this many radii of its foot from the curve of a push before the foot comes to the box, where it
touches nothing."""
CURVE: Final = np.linspace(0.0, 1.0, 201)
"""Parameters at which a curve is searched for the place where the foot meets the box."""


def contact_point(robot: RobotSpec, box: Box, box_pose: Pose2, face: Face, leg: FrontLeg, depth_m: float) -> Floats:
    """Where the centre of the foot ends, (3,), so that its surface is `depth_m` beyond a face of the box."""
    length, width, _ = pushed_box(box, face).size_m
    side = robot.pushing.contact_side_share * width * (1 if leg == "FL" else -1)
    rear = -sqrt(length**2 / 4 - side**2) if box.shape == "cylinder" else -length / 2
    x, y = pushed_pose(box_pose, face).apply([[rear + depth_m - robot.legs.foot_radius_m, side]])[0]
    return np.array([x, y, contact_height_m(robot, box, face)])


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
        self._robot = steps.posture.plant.robot
        self._box = box
        self.resistance = Resistance(box)
        """What holds the box back, as felt up to now."""

    def cycle(self, push: Push, weights: Sequence[float]) -> PushLog:
        """Push, return the foot, and step to the box. Stop early at a fall, and where a foot finds no floor.

        A robot that had to take capture steps walks to the place to push from, and the cycle ends there.

        The `weights` place the inner control points of the foot's curve: two for the cubic curve of a push.

        Raises:
            MotionError: The face cannot be pushed, the robot does not stand at it, its trunk is in the box, or the leg
                does not reach the whole curve. Nothing has moved then.
        """
        posture, robot = self._steps.posture, self._robot
        plant = posture.plant
        leg = LEGS.index(push.leg)
        self._require_face(push.face)
        box, pose = pushed_box(self._box, push.face), pushed_pose(plant.box_pose(), push.face)
        station = behind_box(box, pose, robot.station_m)
        require_within_reach("the place to push from", robot.gait, plant.trunk_pose(), station)
        self._require_apart(box, pose)
        expected = Pose2(x_m=push.depth_m, y_m=0.0, yaw_rad=0.0)
        goal = contact_point(robot, self._box, plant.box_pose(), push.face, push.leg, push.depth_m)
        here = posture.feet_m[:, :2].mean(axis=0)
        force = self._force(push.leg, pose.yaw_rad, float(goal[2]))
        ahead = [
            self._push_step(push.leg, here, posture.yaw_rad, force),
            *self._return_steps(push.leg, behind_box(box, pose @ expected, robot.station_m))[:2],
        ]
        swing = self._bezier_swing(push, weights, goal, None if force is None else pose.yaw_rad)
        within = self._may_be_off(goal, pose.yaw_rad, push.depth_m)
        planned = self._steps.require_reach("the curve of a push", ahead, swing, within)
        logs = [self._steps.take_step(ahead, swing, lands=False, planned=planned)]
        peak = float(np.linalg.norm(logs[0].box_forces_n[:, leg], axis=1).max())
        if not plant.fallen and not self._steps.captured:
            self._feel(push.leg, pose.yaw_rad, logs[0], 0 if force is None else robot.pushing.unload_ticks)
            follow = self._return_steps(push.leg, self._next_station(push.face))
            for index, step in enumerate(follow[:-1]):
                ticks = step.swing_ticks
                swing = self._return_swing(step.target_m) if index == 0 else swing_to(robot, step.target_m, ticks)
                logs.append(self._steps.take_step(follow[index : index + 4], swing))
                if plant.fallen or self._steps.captured:
                    break
                if self._steps.without_floor is not None:
                    logs.append(self._steps.stop())
                    break
        if self._steps.captured and not plant.fallen:
            logs += self._walk_to(self._station(push.face))
        return PushLog(logs=logs, peak_force_n=peak)

    def _require_face(self, face: Face) -> None:
        if face not in PUSHABLE[self._box.shape]:
            valid = ", ".join(PUSHABLE[self._box.shape])
            raise MotionError(f"Expected a face that a {self._box.shape} can be pushed at ({valid}), got {face}")

    def _require_apart(self, box: Box, pose: Pose2) -> None:
        """Check that the box, as seen from its pushed face, is ahead of the trunk and not in it."""
        robot = self._robot
        trunk = pose.inverse() @ self._steps.posture.plant.trunk_pose()
        away_m = -trunk.x_m - box.size_m[0] / 2
        least_m = robot.trunk.ahead_m(robot.stance.height_m - box.size_m[2], trunk.yaw_rad)
        if away_m < least_m:
            raise MotionError(
                f"Expected a face at least {least_m:.2f} m ahead of the middle of the trunk, which is no higher than "
                f"the box of {box.size_m[2]:g} m, got {away_m:.2f} m"
            )

    def _next_station(self, face: Face) -> Pose2:
        """Where to stand after the push: at the box, or in the same place if the box slid out of reach."""
        plant = self._steps.posture.plant
        here = plant.trunk_pose()
        station = self._station(face)
        away = here.inverse() @ station
        gait = self._robot.gait
        near = hypot(away.x_m, away.y_m) <= gait.max_off_m and abs(away.yaw_rad) <= radians(gait.max_off_deg)
        return station if near else here

    def _station(self, face: Face) -> Pose2:
        """Where to stand for a push against a face."""
        box = self._steps.posture.plant.box_pose()
        return behind_box(pushed_box(self._box, face), pushed_pose(box, face), self._robot.station_m)

    def _below(self, trunk: Pose2) -> Pose2:
        """Where the feet stand for a trunk at `trunk`, which leans uphill on a slope.

        They stand farther from a box uphill, but never nearer to one downhill.
        """
        downhill = self._steps.posture.plant.downhill
        if not downhill.any():
            return trunk
        lean_m = _turned(self._robot.stance.com_height_m * np.append(downhill, 0.0), -trunk.yaw_rad)
        return trunk @ Pose2(x_m=min(float(lean_m[0]), 0.0), y_m=float(lean_m[1]), yaw_rad=0.0)

    def _walk_to(self, place: Pose2) -> list[TickLog]:
        """Walk to a place nearby, after capture steps."""
        plant = self._steps.posture.plant
        walk = PathWalk(self._steps, in_world(plant.place_of_world(), (plant.trunk_pose(), place)))
        logs: list[TickLog] = []
        for _ in range(self._robot.capture.most_cycles):
            logs += walk.cycle()
            if plant.fallen or walk.ended:
                break
        return logs

    def _force(self, leg: FrontLeg, yaw_rad: float, height_m: float) -> PushForce | None:
        """The planned force of a push in a direction; None for a light box, which position alone moves.

        It is limited to a share of what the friction of the standing feet can bear: a box that needs more may be one
        that does not move at all.
        """
        motion, felt_n = self._robot.pushing, self.resistance.force_n
        weight_n = self._steps.posture.plant.mass_kg * GRAVITY_M_S2
        size_n = float(np.hypot(felt_n[0], felt_n[1]))
        if felt_n[0] < motion.heavy_share * weight_n:
            return None
        most_n = motion.most_force_share * self._robot.legs.foot_friction * weight_n
        force_n = _turned(felt_n * _mirror(leg), yaw_rad) * min(most_n / size_n, 1.0)
        return PushForce(leg=LEGS.index(leg), force_n=np.outer(heavy_force(motion), force_n), height_m=height_m)

    def _feel(self, leg: FrontLeg, yaw_rad: float, log: TickLog, n_unloading: int) -> None:
        """Let the resistance learn from the step of a push, but for its last ticks, in which the force goes."""
        plant = self._steps.posture.plant
        forces_n = plant.push_forces_n(log, LEGS.index(leg))[: len(log.qpos) - n_unloading]
        self.resistance.feel(_turned(forces_n, -yaw_rad) * _mirror(leg))

    def _push_step(self, leg: FrontLeg, here: Floats, yaw_rad: float, force: PushForce | None) -> Step:
        motion = self._robot.pushing
        return Step(
            leg=leg,
            shift_ticks=motion.shift_ticks,
            swing_ticks=motion.push_ticks if force is None else heavy_ticks(motion),
            target_m=self._steps.posture.feet_m[LEGS.index(leg), :2].copy(),
            nominal_xy_m=here,
            end_velocity_m_s=np.zeros(2),
            end_yaw_rad=yaw_rad,
            margin_m=motion.margin_m if force is None else motion.heavy_margin_m,
            push=force,
        )

    def _return_steps(self, pushing: FrontLeg, to: Pose2) -> list[Step]:
        """The pushing leg to its marker, then the other three, then rest. The trunk moves evenly from step to step."""
        posture, motion = self._steps.posture, self._robot.pushing
        to = self._below(to)
        markers = to.apply(self._robot.stance.foot_rectangle_b())
        here = posture.feet_m[:, :2].mean(axis=0)
        legs: list[Leg] = [pushing, *RESTEP_ORDER[pushing]]
        turn = Pose2(x_m=0.0, y_m=0.0, yaw_rad=posture.yaw_rad).inverse() @ Pose2(x_m=0.0, y_m=0.0, yaw_rad=to.yaw_rad)
        steps = []
        for place, leg in enumerate(legs):
            share = (place + 0.5) / len(legs)
            steps.append(
                Step(
                    leg=leg,
                    shift_ticks=0 if place == 0 else motion.restep_shift_ticks,
                    swing_ticks=motion.return_ticks if place == 0 else motion.restep_swing_ticks,
                    target_m=markers[LEGS.index(leg)],
                    nominal_xy_m=here + share * (to.xy() - here),
                    end_velocity_m_s=np.zeros(2),
                    end_yaw_rad=posture.yaw_rad + turn.yaw_rad * (place + 1) / len(legs),
                    margin_m=motion.margin_m,
                )
            )
        return [*steps, rest(self._robot.gait, to.xy(), to.yaw_rad)]

    def _bezier_swing(
        self, push: Push, weights: Sequence[float], goal_m: Floats, slowly_along_rad: float | None
    ) -> Swing:
        """The curve of the foot to its goal; slowly from the box on if it is heavy, with the direction of the push."""
        floor_m, motion = self._robot.legs.foot_radius_m, self._robot.pushing

        def curve(start_m: Floats) -> Floats:
            points = control_points(start_m, goal_m, weights, push.locus, floor_m)
            if slowly_along_rad is None:
                return bezier(points, gentle_stop(motion.push_ticks))
            to_goal_m = _turned(goal_m - bezier(points, CURVE), -slowly_along_rad)[:, 0]
            meets = CURVE[int(np.argmax(to_goal_m <= push.depth_m))]
            return bezier(points, heavy_way(motion, float(meets)))

        return curve

    def _may_be_off(self, goal_m: Floats, yaw_rad: float, depth_m: float) -> Callable[[Floats], Floats]:
        """How far from its curve a foot may be: at the box by its radius, and farther where it is still on its way."""
        radius_m = self._robot.legs.foot_radius_m

        def within_m(curve_m: Floats) -> Floats:
            to_goal_m = _turned(goal_m - curve_m, -yaw_rad)[:, 0]
            return np.where(to_goal_m > depth_m + radius_m, ON_ITS_WAY_RADII * radius_m, radius_m)

        return within_m

    def _return_swing(self, target_m: Floats) -> Swing:
        """A swing from the box back and down to the marker."""
        end_m, return_ticks = [*target_m, self._robot.touchdown_m], self._robot.pushing.return_ticks
        gait = self._robot.gait

        def curve(start_m: Floats) -> Floats:
            return landing_swing(start_m, end_m, 0.0, return_ticks, gait)

        return curve


def _turned(vectors: Floats, yaw_rad: float) -> Floats:
    """Vectors, (..., 3), turned about the vertical."""
    c, s = cos(yaw_rad), sin(yaw_rad)
    turned: Floats = vectors @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
    return turned


def _mirror(leg: FrontLeg) -> Floats:
    """Signs by which a vector of one leg becomes that of FL, and back, (3,)."""
    return np.ones(3) if leg == "FL" else MIRRORED
