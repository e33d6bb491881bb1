"""Where the readings of each sensor of the model are among all of them."""

from collections.abc import Callable

from legpush.arrays import Floats
from legpush.scene.conventions import LEGS
from sim_proc.control.plant import StepLog
from sim_proc.control.watch import Watch
from sim_proc.headless import mujoco


class Sensors:
    """Columns of MuJoCo's `sensordata`. Those of the legs stand side by side in the order of `LEGS`."""

    def __init__(self, model: mujoco.MjModel) -> None:
        self.of = {model.sensor(i).name: _columns(model, i) for i in range(model.nsensor)}
        """Columns of each sensor by its name."""
        self.joint_positions, self.joint_velocities, self.joint_torques = (
            self._from_to(f"FL_hip_x_{what}", f"RR_knee_{what}") for what in ("position", "velocity", "torque")
        )
        """Columns of the twelve joints."""
        self.n_contacts = self._from_to("FL_floor_contacts", "contacts")
        """Columns of the numbers of contacts, in the order of the model."""
        forces = self._from_to("FL_foot_force", "RR_foot_force")
        self.loads = slice(forces.start + 2, forces.stop, 3)
        """Columns of the vertical forces of the feet on their surroundings."""
        self._tips = self._from_to("FL_tip", "RR_tip")
        self._floor_forces = self._from_to("FL_floor_force", "RR_floor_force")
        self._box_forces = self._from_to("FL_box_force", "RR_box_force")

    def tips_m(self, readings: Floats) -> Floats:
        """Centres of the foot spheres, (..., 4, 3), from all readings, (..., n)."""
        tips: Floats = readings[..., self._tips].reshape(*readings.shape[:-1], len(LEGS), 3)
        return tips

    def loads_n(self, readings: Floats) -> Floats:
        """What the feet carry, (..., 4), from all readings, (..., n)."""
        loads: Floats = -readings[..., self.loads]
        return loads

    def motion(self, readings: Floats) -> tuple[Floats, Floats, Floats]:
        """Centre of mass, (n, 3), its velocity, and tips, (n, 4, 3), at the last steps of ticks.

        `readings` are those of all steps, (n, steps, m).
        """
        last = readings[:, -1]
        return last[:, self.of["com"]], last[:, self.of["com_velocity"]], self.tips_m(last)

    def imu(self, readings: Floats) -> tuple[Floats, Floats]:
        """Accelerations at all steps, (n, steps, 3), and attitudes at the last steps of ticks, (n, 4), of the IMU."""
        return readings[..., self.of["imu_acceleration"]], readings[:, -1, self.of["imu_orientation"]]

    def alarm(self, watch: Watch, readings: Floats, felt_n: Callable[[Floats], Floats]) -> int | None:
        """The first tick after which a motion, (ticks, steps, n), is too far from the plan, if it is.

        A foot that presses the box hard moves the robot as a gust does: then there is no alarm. Such a motion, and one
        in which a foot presses as hard on average, tells nothing of the usual deviation. `felt_n` returns how hard any
        foot presses in each tick as far as it is felt, (ticks,), from the forces of the box on the feet at all steps,
        (ticks, steps, 4, 3).
        """
        alarm = watch.alarm(*self.motion(readings))
        if not readings[..., self._box_forces].any():
            return alarm
        pressing_n = felt_n(self.box_forces_n(readings))
        if alarm is not None and pressing_n[alarm] > watch.pressing_n:
            alarm = None
            watch.forget()
        elif alarm is None and pressing_n.mean() > watch.pressing_n:
            watch.forget()
        return alarm

    def floor_forces_n(self, readings: Floats) -> Floats:
        """Forces of the floor on the feet, (..., 4, 3), from all readings, (..., n)."""
        forces: Floats = -readings[..., self._floor_forces].reshape(*readings.shape[:-1], len(LEGS), 3)
        return forces

    def box_forces_n(self, readings: Floats) -> Floats:
        """Forces of the box on the feet, (..., 4, 3), from all readings, (..., n)."""
        forces: Floats = -readings[..., self._box_forces].reshape(*readings.shape[:-1], len(LEGS), 3)
        return forces

    def foot_forces_n(self, readings: Floats) -> Floats:
        """Forces of floor and box on the feet, (..., 4, 3), from all readings, (..., n)."""
        return self.floor_forces_n(readings) + self.box_forces_n(readings)

    def steps(self, readings: Floats) -> StepLog:
        """The measurements in the readings (ticks, steps, n) of physics steps."""
        return StepLog(
            tips_m=self.tips_m(readings),
            floor_forces_n=self.floor_forces_n(readings),
            box_forces_n=self.box_forces_n(readings),
            com_m=readings[..., self.of["com"]],
            com_velocity_m_s=readings[..., self.of["com_velocity"]],
            joint_positions_rad=readings[..., self.joint_positions],
            joint_velocities_rad_s=readings[..., self.joint_velocities],
            joint_torques_n_m=readings[..., self.joint_torques],
            trunk_velocity_m_s=readings[..., self.of["imu_velocity"]],
            imu_angular_velocity_rad_s=readings[..., self.of["imu_angular_velocity"]],
            imu_acceleration_m_s2=readings[..., self.of["imu_acceleration"]],
        )

    def _from_to(self, first: str, last: str) -> slice:
        return slice(self.of[first].start, self.of[last].stop)


def _columns(model: mujoco.MjModel, sensor: int) -> slice:
    start = int(model.sensor_adr[sensor])
    return slice(start, start + int(model.sensor_dim[sensor]))
