"""Walks along a path in a static crawl, one gait cycle of four steps at a time."""

from collections.abc import Sequence
from dataclasses import replace
from math import degrees, hypot, radians

import numpy as np

from legpush.arrays import Floats
from legpush.errors import MotionError
from legpush.geometry import Pose2, wrap_angle
from legpush.messages.stepping import PathProgress
from legpush.scene.conventions import CONTROL_PERIOD_S, LEGS
from legpush.scene.robot import RobotSpec
from legpush.scene.robot_motion import Gait
from sim_proc.control.footsteps import GAIT_ORDER, CycleTargets, PosePath, next_cycle
from sim_proc.control.plant import TickLog
from sim_proc.control.step import Step, Swing, rest
from sim_proc.control.steps import Steps
from sim_proc.control.swing import landing_swing


class PathWalk:
    """A walk along one path, cycle by cycle."""

    def __init__(self, steps: Steps, waypoints: Sequence[Pose2]) -> None:
        """Begin the path where the robot stands or walks.

        Raises:
            MotionError: The path begins too far from the robot.
        """
        plant = steps.posture.plant
        self._steps = steps
        self._robot = plant.robot
        self._waypoints = tuple(waypoints)
        """In the frame of the world."""
        self._place_of_world = plant.place_of_world()
        self._path = PosePath(plant.robot, self._measured(self._waypoints))
        begin = self._measured(self._waypoints[:1])[0]
        require_within_reach("a path that begins", plant.robot.gait, plant.trunk_pose(), begin)
        self._length_m = self._path.length_m
        """Length of the path that was asked for. After capture steps another one leads back to it."""
        self._before_m = 0.0
        """Travelled length at the beginning of the path that is walked now; below 0 after a way back."""
        self._travelled = np.zeros(4)
        self._hole_at: Step | None = None
        """The step whose foot found no floor."""
        if not self._begins_apart():
            self._lead_to(self._measured(self._waypoints))

    def _measured(self, waypoints: tuple[Pose2, ...]) -> tuple[Pose2, ...]:
        """Waypoints in the frame of the measurements, as the robot is located now."""
        place = self._place_of_world
        return waypoints if place is None else tuple(place @ waypoint for waypoint in waypoints)

    def _locate(self) -> None:
        """Move the path to where it is by the last localization. Its length is only rounded otherwise."""
        place = self._steps.posture.plant.place_of_world()
        if place != self._place_of_world:
            at_end = self._travelled >= self._path.length_m
            self._place_of_world = place
            self._path = PosePath(self._robot, self._measured(self._waypoints))
            self._travelled[at_end] = self._path.length_m

    @property
    def ended(self) -> bool:
        """Whether the walk is over: at the end of the path, or before a place without floor."""
        return self._hole_at is not None or self.progress().done

    def progress(self) -> PathProgress:
        """Travelled length of the feet. A turn on the spot counts by the arc that the feet describe."""
        done = bool((self._travelled >= self._path.length_m).all())
        travelled_m = max(self._before_m + float(self._travelled.mean()), 0.0)
        return PathProgress(travelled_m=travelled_m, length_m=self._length_m, done=done)

    def cycle(self) -> list[TickLog]:
        """Take one step with each leg, and come to rest after the last cycle of the path.

        Stop early at a fall, and come to rest before a place where a foot finds no floor.

        Raises:
            MotionError: A foot found no floor at its place on the path in an earlier cycle.
        """
        posture, gait = self._steps.posture, self._robot.gait
        if self._hole_at is not None:
            x, y = self._hole_at.target_m
            raise MotionError(
                f"Expected floor at most {gait.search_depth_m:g} m below the place of the foot {self._hole_at.leg} at "
                f"({x:.2f}, {y:.2f}), found none: expected another `follow` before `walk`"
            )
        self._locate()
        feet = posture.feet_m[:, :2]
        this = next_cycle(self._path, self._travelled, feet)
        following = next_cycle(self._path, this.travelled_m, this.feet_m)
        ahead = self._steps_of(self._travelled, this) + self._steps_of(this.travelled_m, following)
        if not self._travelled.any():
            ahead[0] = replace(ahead[0], shift_ticks=gait.first_shift_ticks)
        ahead = self._turned_slowly(ahead)
        logs = []
        for index in range(len(GAIT_ORDER)):
            swing = swing_to(self._robot, ahead[index].target_m, gait.swing_ticks)
            logs.append(self._steps.take_step(ahead[index : index + 4], swing))
            if posture.plant.fallen:
                return logs
            if self._steps.captured:
                self._rejoin()
                return logs
            if self._steps.without_floor is not None:
                self._hole_at = ahead[index]
                return [*logs, self._steps.stop()]
        self._travelled = this.travelled_m
        if self.progress().done:
            logs.append(self._steps.take_step([self._rest()], None))
            posture.com_state[1:] = 0.0
            if self._steps.captured and not posture.plant.fallen:
                self._rejoin()
        return logs

    def _rejoin(self) -> None:
        """Lead the path from where the robot stands after capture steps back to where it was going."""
        here = self._steps.posture.plant.trunk_pose()
        at_m = float(self._travelled.mean())
        x, y, _ = self._path.poses(np.array(at_m))
        ahead_m = max(self._robot.gait.stride_m, hypot(here.x_m - x, here.y_m - y))
        self._lead_to(self._path.ahead_of(min(at_m + ahead_m, self._path.length_m)))

    def _begins_apart(self) -> bool:
        """Whether the feet keep apart in the first cycle. They may not where the path begins beside the robot."""
        feet = self._steps.posture.feet_m[:, :2]
        first = next_cycle(self._path, self._travelled, feet)
        return bool(self._path.are_apart(feet, first.feet_m[None])[0])

    def _lead_to(self, measured: tuple[Pose2, ...]) -> None:
        """Walk on along these waypoints, from where the robot stands to the first of them at the beginning."""
        here = self._steps.posture.plant.trunk_pose()
        self._waypoints = in_world(self._place_of_world, (here, *measured))
        self._path, self._travelled = PosePath(self._robot, self._measured(self._waypoints)), np.zeros(4)
        self._before_m = self._length_m - self._path.length_m

    def _steps_of(self, before: Floats, targets: CycleTargets) -> list[Step]:
        """The four steps of a cycle, during which the trunk advances evenly."""
        gait = self._robot.gait
        start, end = float(before.mean()), float(targets.travelled_m.mean())
        n_legs = len(GAIT_ORDER)
        duration = n_legs * (gait.shift_ticks + gait.swing_ticks) * CONTROL_PERIOD_S
        swing_share = 1 - gait.swing_ticks / (2 * (gait.shift_ticks + gait.swing_ticks))
        places = np.arange(n_legs)
        middle, finish = (start + (end - start) * (places + share) / n_legs for share in (swing_share, 1.0))
        middle, finish, behind, ahead = self._path.poses(np.stack([middle, finish, finish - 0.01, finish + 0.01]))
        velocities = (ahead[:, :2] - behind[:, :2]) / 0.02 * (end - start) / duration
        steps = []
        for place, leg in enumerate(GAIT_ORDER):
            steps.append(
                Step(
                    leg=leg,
                    shift_ticks=gait.shift_ticks,
                    swing_ticks=gait.swing_ticks,
                    target_m=targets.feet_m[LEGS.index(leg)],
                    nominal_xy_m=middle[place, :2],
                    end_velocity_m_s=velocities[place],
                    end_yaw_rad=float(finish[place, 2]),
                    margin_m=gait.margin_m,
                )
            )
        return steps

    def _turned_slowly(self, steps: Sequence[Step]) -> list[Step]:
        """The same steps, in none of which the trunk turns farther than in an even part of a cycle's largest turn.

        A path that begins with another heading than the robot's, or that bends sharply, would turn it at once.
        """
        most_rad, yaw_rad, slow = self._robot.gait.max_turn_rad / len(GAIT_ORDER), self._steps.posture.yaw_rad, []
        for step in steps:
            yaw_rad += min(max(wrap_angle(step.end_yaw_rad - yaw_rad), -most_rad), most_rad)
            slow.append(replace(step, end_yaw_rad=yaw_rad))
        return slow

    def _rest(self) -> Step:
        end = self._path.poses(np.array(self._path.length_m))
        return rest(self._robot.gait, end[:2], float(end[2]))


def in_world(place_of_world: Pose2 | None, measured: Sequence[Pose2]) -> tuple[Pose2, ...]:
    """Poses in the frame of the world, whose own place in the frame of the measurements is `place_of_world`."""
    if place_of_world is None:
        return tuple(measured)
    from_measured = place_of_world.inverse()
    return tuple(from_measured @ pose for pose in measured)


def require_within_reach(what: str, gait: Gait, trunk: Pose2, place: Pose2) -> None:
    """Check that the trunk is near enough to `place` for the feet to step there; `what` names it in the error.

    Raises:
        MotionError: The place is too far away, or turned too much.
    """
    away = trunk.inverse() @ place
    distance_m, turn_rad = hypot(away.x_m, away.y_m), abs(away.yaw_rad)
    if distance_m > gait.max_off_m or turn_rad > radians(gait.max_off_deg):
        raise MotionError(
            f"Expected {what} at most {gait.max_off_m:g} m and {gait.max_off_deg:.0f}° from the trunk, "
            f"got {distance_m:.2f} m and {degrees(turn_rad):.0f}°"
        )


def swing_to(robot: RobotSpec, target_m: Floats, n_ticks: int) -> Swing:
    """A swing that lands slowly at `target_m` (2,)."""
    end_m = [*target_m, robot.touchdown_m]
    return lambda start_m: landing_swing(start_m, end_m, robot.gait.step_height_m, n_ticks, robot.gait)
