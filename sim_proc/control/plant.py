"""What control needs of a robot: the plant that it drives, and the log of its ticks."""

from dataclasses import dataclass
from typing import Protocol

from legpush.arrays import Floats
from legpush.geometry import Pose2


@dataclass(frozen=True, kw_only=True)
class TickLog:
    """What was measured at each tick, one row per tick; all but `qpos` as of 2 ms before its end."""

    qpos: Floats
    """(n, 26): trunk (7), joints (12), box (7)."""
    tips_m: Floats
    """(n, 4, 3)"""
    floor_forces_n: Floats
    """(n, 4, 3), of the floor on each foot."""
    box_forces_n: Floats
    """(n, 4, 3), of the box on each foot."""
    com_m: Floats
    """(n, 3), of the robot."""
    ctrl: Floats
    """(n, 12), what the servos were commanded."""


class Plant(Protocol):
    """A robot beside a box that control can measure and move: simulated here, hardware elsewhere. World frame."""

    fallen: bool
    """Whether the robot has fallen; it cannot be moved any more."""

    @property
    def mass_kg(self) -> float:
        """Mass of the robot."""

    @property
    def downhill(self) -> Floats:
        """How far from its foot on the floor a plumb line of unit height ends, (2,)."""

    def trunk_pose(self) -> Pose2:
        """Pose of the trunk, projected to the floor."""

    def box_pose(self) -> Pose2:
        """Pose of the box, projected to the floor."""

    def joints_rad(self) -> Floats:
        """Joint angles, (12,)."""

    def tips_m(self) -> Floats:
        """Centres of the foot spheres, (4, 3)."""

    def com_m(self) -> Floats:
        """Centre of mass of the robot, (3,)."""

    def run(self, joint_commands_rad: Floats, joint_torques_n_m: Floats) -> TickLog:
        """Track joint commands (n, 12) with feed-forward torques (n, 12), one row per tick; stops short at a fall."""
