"""The sensors of the model as the log of physics steps."""

from collections.abc import Mapping

from legpush.arrays import Floats
from legpush.scene.conventions import LEG_JOINTS, LEGS
from sim_proc.control.plant import StepLog


class StepSensors:
    """Where the readings that are logged lie among all sensors."""

    def __init__(self, columns: Mapping[str, slice]) -> None:
        """Find them in the columns of all sensors, by name."""

        def along(first: str, last: str) -> slice:
            return slice(columns[first].start, columns[last].stop)

        feet = [along(f"{LEGS[0]}_{what}", f"{LEGS[-1]}_{what}") for what in ("tip", "floor_force", "box_force")]
        self._tips, self._floor_forces, self._box_forces = feet
        self._com, self._com_velocity = columns["com"], columns["com_velocity"]
        self._joints = [
            along(f"{LEG_JOINTS[0]}_{what}", f"{LEG_JOINTS[-1]}_{what}") for what in ("position", "velocity", "torque")
        ]

    def joints(self, sensors: Floats) -> tuple[Floats, Floats, Floats]:
        """Angles, speeds and torques of the joints, (n, s, 12) each, from readings (n, s, nsensordata)."""
        positions, velocities, torques = (sensors[:, :, columns] for columns in self._joints)
        return positions, velocities, torques

    def log(self, sensors: Floats) -> StepLog:
        """The log of s steps in each of n ticks, from their readings (n, s, nsensordata)."""
        feet = (*sensors.shape[:2], len(LEGS), 3)
        positions, velocities, torques = self.joints(sensors)
        return StepLog(
            tips_m=sensors[:, :, self._tips].reshape(feet),
            floor_forces_n=-sensors[:, :, self._floor_forces].reshape(feet),
            box_forces_n=-sensors[:, :, self._box_forces].reshape(feet),
            com_m=sensors[:, :, self._com],
            com_velocity_m_s=sensors[:, :, self._com_velocity],
            joint_positions_rad=positions,
            joint_velocities_rad_s=velocities,
            joint_torques_n_m=torques,
        )
