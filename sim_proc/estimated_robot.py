"""The simulated robot as control knows it when its sensors are not exact: a `Plant` whose measures are estimates."""

from math import ceil

import numpy as np

from legpush.arrays import Flags, Floats
from legpush.geometry import Pose2
from legpush.messages.stepping import BoxState, Perceived
from legpush.scene.conventions import LEGS
from legpush.scene.robot import RobotSpec
from sim_proc.control.body_state import BodyState
from sim_proc.control.joint_commands import COMMANDS_PER_TICK, JointCommands, Knots
from sim_proc.control.plant import TickLog, Touchdown
from sim_proc.control.watch import Watch
from sim_proc.estimation.body import body_numbers
from sim_proc.estimation.command_lag import LAGS, CommandLag
from sim_proc.estimation.estimator import Estimator
from sim_proc.estimation.map_filter import MapFilter
from sim_proc.estimation.readings import JOINTS
from sim_proc.physics.physics import Physics
from sim_proc.physics.senses import OwnSenses

STILL_TICKS = 15
"""Ticks at the end of its standing in which the robot is taken to be at rest."""


class EstimatedRobot:
    """The robot of a `Physics`, measured by its own sensors alone.

    The frame of its measurements is the one of the true world when it begins, and drifts from there. Where the world is
    in it is known from the fixes of its localization. The box is seen from the robot: its place beside the robot is as
    good as it is perceived.
    """

    def __init__(self, physics: Physics, senses: OwnSenses) -> None:
        """Begin the estimate where the robot has stood still, and the episode begins."""
        self._physics, self._senses = physics, senses
        assumed = physics.assumed
        body = body_numbers(physics.robot, np.array(assumed.model.opt.gravity), *assumed.moments())
        still = senses.last[-STILL_TICKS:].reshape(-1, senses.last.shape[-1])
        # A reading tells of the beginning of its step.
        self._estimator = Estimator(body, physics.trunk_pose(), still, senses.late_steps + 1)
        self._late_ticks = max(ceil(senses.late_steps / COMMANDS_PER_TICK), 1)
        self._whole_late_ticks = senses.late_steps // COMMANDS_PER_TICK
        """Ticks after a lift from which on readings tell of it, and for which they cannot tell of a touchdown."""
        self._lag = CommandLag(self._estimator.joints_rad(), senses.late_steps)
        n_past = int(LAGS[-1]) // COMMANDS_PER_TICK + 1 + self._late_ticks
        self._planned_up: Flags = np.zeros((n_past, len(LEGS)), dtype=np.bool_)
        """Which feet were lifted by plan in the last ticks."""
        self.lifted: Flags = self._planned_up[:0]
        """The same in the ticks of the last run, as far as their readings tell of them, (n, 4)."""
        self._state = self._estimator.state()
        fix = physics.perception.first_fix()
        self._map = None if fix is None else MapFilter(fix, self.trunk_pose())

    @property
    def robot(self) -> RobotSpec:
        """The numbers of the robot, as control knows them."""
        return self._physics.robot

    @property
    def mass_kg(self) -> float:
        """Mass of the robot, as control knows it."""
        return self._physics.mass_kg

    @property
    def downhill(self) -> Floats:
        """Where a plumb line from one metre above the floor meets it, relative to the point below that, [m/m], (2,)."""
        return self._estimator.downhill

    @property
    def late_ticks(self) -> int:
        """By how many ticks the joints are known to move later than they are commanded to."""
        return self._lag.ticks

    @property
    def fallen(self) -> bool:
        """Whether the robot has fallen."""
        return self._physics.fallen

    def inverse_dynamics_n_m(self, motion: Knots, yaw_rad: Floats) -> Floats:
        """Torques at all knots but the first, (n, 12): what a motion of the joints takes."""
        return self._physics.inverse_dynamics_n_m(motion, yaw_rad)

    def run(self, commands: JointCommands, until: Touchdown | None = None, watch: Watch | None = None) -> TickLog:
        """Track joint commands as `Physics.run` does, and estimate the motion afterwards."""
        physics, first_tick = self._physics, self._physics.tick + 1
        watched = None if watch is None else _WatchedEstimate(self, commands, until, watch)
        log = physics.run(commands, until, watched)
        n_ticks = len(log.qpos)
        self._lag = self._lag_after(commands, self._senses.last)
        self.lifted = self._lifted(n_ticks, until, self._lag)
        self._estimator.advance(self._senses.last, self.lifted)
        self._planned_up = np.concatenate([self._planned_up, _up(n_ticks, until)])[-len(self._planned_up) :]
        self._senses.tare_n = self._estimator.tare_n
        self._state = self._estimator.state()
        if self._map is not None:
            fixes, latency_ticks = physics.perception.fixes()
            self._map.take(first_tick, self._estimator.trunk_poses(), fixes, latency_ticks)
        return log

    def _lag_after(self, commands: JointCommands, readings: Floats) -> CommandLag:
        """What is known of late commands after the ticks of a run with readings (n, steps, N_READINGS)."""
        return self._lag.after(commands.positions_rad[: len(readings)], readings[:, -1, JOINTS])

    def _lifted(self, n_ticks: int, until: Touchdown | None, lag: CommandLag) -> Flags:
        """Which feet are lifted by plan in the ticks of a run, as far as their readings tell of them, (n, 4)."""
        planned = np.concatenate([self._planned_up, _up(n_ticks, until)])
        begun, ended = (
            planned[len(planned) - n_ticks - late_ticks :][:n_ticks]
            for late_ticks in (lag.ticks + self._late_ticks, lag.ticks + self._whole_late_ticks)
        )
        lifted: Flags = begun & ended
        return lifted

    def foresee(self, n_ticks: int, commands: JointCommands, until: Touchdown | None) -> tuple[Floats, Floats, Floats]:
        """Centre of mass and its velocity, (n, 3) each, and feet, (n, 4, 3), as estimated in the ticks of the run."""
        readings = self._senses.readings(n_ticks)
        lifted = self._lifted(n_ticks, until, self._lag_after(commands, readings))
        return self._estimator.foresee(readings, lifted)

    def push_forces_n(self, log: TickLog, leg: int) -> Floats:
        """Forces of a foot on the box as the foot feels them, means over each tick of the last run, (n, 3)."""
        return self._physics.push_forces_n(log, leg)

    def body_state(self) -> BodyState:
        """The motion of trunk, feet and centre of mass, as it is estimated."""
        return self._state

    def trunk_pose(self) -> Pose2:
        """Pose of the trunk, projected to the floor."""
        x, y, _ = self._state.position_m.tolist()
        rotation = self._state.rotation
        return Pose2(x_m=x, y_m=y, yaw_rad=float(np.arctan2(rotation[1, 0], rotation[0, 0])))

    def tips_m(self) -> Floats:
        """Centres of the foot spheres, (4, 3)."""
        return self._state.tips_m

    def com_m(self) -> Floats:
        """Centre of mass of the robot, (3,)."""
        return self._state.com_m

    def joints_rad(self) -> Floats:
        """Joint angles, (12,)."""
        return self._estimator.joints_rad()

    def box_pose(self) -> Pose2:
        """Pose of the box as it is seen from the robot, projected to the floor."""
        return self._drift() @ self._physics.box_pose()

    def place_of_world(self) -> Pose2:
        """Where the frame of the world is taken to be, in the one of all measurements."""
        return self._drift() if self._map is None else self._map.place

    def _drift(self) -> Pose2:
        """Pose of the frame of the true world in the one of all measurements."""
        return self.trunk_pose() @ self._physics.trunk_pose().inverse()

    def perceived(self) -> Perceived:
        """What is known of robot and box in the world."""
        physics = self._physics
        box = physics.perception.box(physics.data.qpos).tolist()
        return Perceived(
            trunk=self.place_of_world().inverse() @ self.trunk_pose(),
            trunk_tick=physics.tick if self._map is None else self._map.last_tick,
            box=BoxState(position_m=tuple(box[:3]), orientation_wxyz=tuple(box[3:])),
            box_tick=physics.perception.box_tick(physics.tick),
        )

    def as_bytes(self) -> bytes:
        """All that later estimates depend on, but what the sensors read."""
        known = self._estimator.as_bytes() + self._lag.as_bytes()
        return known + (b"" if self._map is None else self._map.as_bytes())


def _up(n_ticks: int, until: Touchdown | None) -> Flags:
    """Which feet are lifted by plan in the ticks of a run, (n, 4)."""
    up = np.zeros((n_ticks, len(LEGS)), dtype=np.bool_)
    if until is not None:
        up[until.lift_tick : until.first_tick - until.late_ticks, until.leg] = True
    return up


class _WatchedEstimate(Watch):
    """A `Watch` that looks at the estimate in the place of the truth."""

    def __init__(self, robot: EstimatedRobot, commands: JointCommands, until: Touchdown | None, watch: Watch) -> None:
        self._robot, self._commands, self._until, self._watch = robot, commands, until, watch
        self.pressing_n = watch.pressing_n

    def forget(self) -> None:
        """Take the motion that was looked at last for one that tells nothing of the usual deviation."""
        self._watch.forget()

    def alarm(self, com_m: Floats, com_velocity_m_s: Floats, tips_m: Floats) -> int | None:
        """The first tick after which the motion is estimated to be too far from the plan, if it is."""
        del com_velocity_m_s, tips_m
        return self._watch.alarm(*self._robot.foresee(len(com_m), self._commands, self._until))
