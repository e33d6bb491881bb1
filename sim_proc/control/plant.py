"""`Plant`, the robot as walking and pushing measure and move it, and `TickLog`, the record of its ticks and of their
physics steps."""

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Any, Protocol

import numpy as np

from legpush.arrays import Floats
from legpush.geometry import Pose2
from legpush.scene.robot import RobotSpec
from sim_proc.control.body_state import BodyState
from sim_proc.control.joint_commands import JointCommands, Knots
from sim_proc.control.watch import Watch


@dataclass(frozen=True, kw_only=True)
class StepLog:
    """Measurements at the beginning of each physics step of 2 ms: s steps in each of n ticks, world frame."""

    tips_m: Floats
    """Centres of the foot spheres, (n, s, 4, 3)."""
    floor_forces_n: Floats
    """Forces of the floor on the feet, (n, s, 4, 3)."""
    box_forces_n: Floats
    """Forces of the box on the feet, (n, s, 4, 3)."""
    com_m: Floats
    """Centre of mass of the robot, (n, s, 3)."""
    com_velocity_m_s: Floats
    """Its velocity, (n, s, 3)."""
    joint_positions_rad: Floats
    """Angles of the joints, (n, s, 12)."""
    joint_velocities_rad_s: Floats
    """Speeds of the joints, (n, s, 12)."""
    joint_torques_n_m: Floats
    """Torques of the servos, (n, s, 12)."""
    trunk_velocity_m_s: Floats
    """Velocity of the middle of the trunk, (n, s, 3)."""
    imu_angular_velocity_rad_s: Floats
    """Of the trunk, in its own frame, (n, s, 3)."""
    imu_acceleration_m_s2: Floats
    """Of the trunk less gravity, in its own frame, (n, s, 3)."""

    def forces_on_box_n(self, leg: int) -> Floats:
        """Mean force of a foot on the box in each tick, (n, 3)."""
        forces: Floats = -self.box_forces_n[:, :, leg].mean(axis=1)
        return forces


def joined_steps(logs: Sequence[StepLog]) -> StepLog:
    """The steps of motions that followed one another."""
    if len(logs) == 1:
        return logs[0]
    return StepLog(
        **{field.name: np.concatenate([getattr(log, field.name) for log in logs]) for field in fields(StepLog)}
    )


@dataclass(frozen=True, kw_only=True)
class Touchdown:
    """The contact of a swinging foot with the floor, as the foot's force sensor feels it.

    If it comes before the planned landing, the run ends with the tick.
    """

    leg: int
    force_n: float
    """Vertical force from which on the foot is down."""
    lift_tick: int
    """Tick of the run in which the foot is lifted. If then another foot is not down, the run ends before it."""
    carried: tuple[int, ...]
    """Legs that were found to be carried, if not by their feet. They may be off the floor at the lift."""
    first_tick: int
    """Tick of the run from which on the force counts. Before, the foot is lifted."""
    landing_tick: int
    """Tick of the run in which the planned landing begins. From then on the run goes on to its end."""
    blocked_tick: int
    """Tick of the run from which on a leg that something else stops is down, too, such as an edge under its shank."""
    stops_leg: bool
    """Whether the leg stops within a physics step, because the foot moves fast, and does not go on to the end of the
    tick."""
    late_ticks: int = 0
    """By how many ticks commands were known to come late: `first_tick` and the later ones count them in."""


@dataclass(frozen=True, kw_only=True)
class TickLog:
    """Measurements of a motion, one row per tick, world frame.

    `qpos` is that of the end of the tick. The other quantities are up to 2 ms older: a physics engine computes them at
    the beginning of its last step within the tick.
    """

    qpos: Floats
    """(n, 26): pose of the trunk (7), joint angles (12), pose of the box (7)."""
    tips_m: Floats
    """Centres of the foot spheres, (n, 4, 3)."""
    floor_forces_n: Floats
    """Forces of the floor on the feet, (n, 4, 3)."""
    box_forces_n: Floats
    """Forces of the box on the feet, (n, 4, 3)."""
    com_m: Floats
    """Centre of mass of the robot, (n, 3)."""
    ctrl: Floats
    """Positions commanded to the servos, with all feed-forward, (n, COMMANDS_PER_TICK, 12)."""
    steps: StepLog
    """The physics steps of these ticks."""
    touched_down: bool
    """Whether the motion ended with the touchdown that was to end it."""
    not_down: int | None = None
    """The leg whose foot was not down when another one was to be lifted. It ended the motion."""
    left_plan: bool = False
    """Whether the motion ended because the robot was too far from the plan."""


def joined(logs: Sequence[TickLog]) -> TickLog:
    """The log of motions that followed one another. It ended as the last one did."""
    if len(logs) == 1:
        return logs[0]
    ends: dict[str, Any] = {name: getattr(logs[-1], name) for name in ("touched_down", "not_down", "left_plan")}
    names = [field.name for field in fields(TickLog) if field.name not in ("steps", *ends)]
    rows: dict[str, Any] = {name: np.concatenate([getattr(log, name) for log in logs]) for name in names}
    return TickLog(**rows, steps=joined_steps([log.steps for log in logs]), **ends)


class Plant(Protocol):
    """A robot beside a box, which control can measure and move: simulated here, hardware elsewhere. World frame."""

    @property
    def fallen(self) -> bool:
        """Whether the robot has fallen. A fallen robot cannot be moved any more."""

    @property
    def robot(self) -> RobotSpec:
        """The numbers of the robot."""

    @property
    def mass_kg(self) -> float:
        """Mass of the robot."""

    @property
    def downhill(self) -> Floats:
        """Where a plumb line from one metre above the floor meets it, relative to the point below that, [m/m], (2,).

        Zero on a level floor.
        """

    @property
    def late_ticks(self) -> int | None:
        """By how many ticks the joints are known to move later than they are commanded to; None if nobody looks."""

    def trunk_pose(self) -> Pose2:
        """Pose of the trunk, projected to the floor."""

    def box_pose(self) -> Pose2:
        """Pose of the box as it is perceived, projected to the floor."""

    def place_of_world(self) -> Pose2 | None:
        """Where the frame of the world, in which paths are, is taken to be in the frame of all measurements.

        None if they are the same.
        """

    def body_state(self) -> BodyState:
        """The motion of trunk, feet and centre of mass, as it is known now."""

    def joints_rad(self) -> Floats:
        """Joint angles, (12,)."""

    def tips_m(self) -> Floats:
        """Centres of the foot spheres, (4, 3)."""

    def com_m(self) -> Floats:
        """Centre of mass of the robot, (3,)."""

    def push_forces_n(self, log: TickLog, leg: int) -> Floats:
        """Forces of a foot on the box as the foot feels them, means over each tick of the last run, (n, 3)."""

    def inverse_dynamics_n_m(self, motion: Knots, yaw_rad: Floats) -> Floats:
        """Torques at all knots but the first, (n, 12): what a motion of the joints takes.

        The trunk is level and at rest, turned by `yaw_rad` (n,), and nothing touches the feet.
        """

    def run(self, commands: JointCommands, until: Touchdown | None = None, watch: Watch | None = None) -> TickLog:
        """Track joint commands, one row per tick; stop early at a fall, or after the tick of a touchdown or an alarm.

        The motion that is watched is that of the centre of mass as it is known in each tick.
        """
