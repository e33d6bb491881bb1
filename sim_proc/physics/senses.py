"""What the robot's own sensors read: too much or too little, with noise, and late."""

from collections.abc import Iterable, Iterator
from math import sqrt
from typing import Final

import numpy as np

from legpush.arrays import Floats
from legpush.realism.reality import ENCODER_STREAM, FORCE_STREAM, IMU_STREAM, PUSH_STREAM, Reality
from sim_proc.control.joint_commands import COMMANDS_PER_TICK
from sim_proc.estimation.readings import ACCELERATION, FORCES, GYRO, JOINTS, N_READINGS
from sim_proc.headless import mujoco
from sim_proc.model.world import PHYSICS_STEP_S
from sim_proc.physics.landing import Landing
from sim_proc.physics.sensors import Sensors

CHUNK_TICKS: Final = 64
"""Ticks whose noise comes from one generator: the chunk that a tick is in says which one, however runs are split."""
FIRST_CHUNK: Final = 2
"""Number of the chunk of tick 0 in its stream. The robot stands in the chunk before; numbers without one are biases."""
STREAMS: Final = (
    (IMU_STREAM, slice(GYRO.start, ACCELERATION.stop)),
    (ENCODER_STREAM, JOINTS),
    (FORCE_STREAM, FORCES),
)
"""Streams of random numbers, and the columns of the readings that they disturb."""


class ExactSenses:
    """Sensors that read what is, at once: a row of readings is that of all sensors of the model."""

    late_steps = 0
    """Age of a reading when it is given."""
    least_touch_n = 0.0
    """Least force by which a foot is known to be down."""

    def __init__(self, sensors: Sensors) -> None:
        self.forces, self.joints = sensors.loads, sensors.joint_positions
        """Columns of the vertical forces of the feet on their surroundings, and of the joint angles."""

    def begin_run(self, tick: int, n_ticks: int) -> None:
        """Begin a run of at most `n_ticks` after `tick`."""

    def feel(self, step: int, sensors: Floats) -> None:
        """Take all sensors of the model, (n, nsensordata), in the steps of the run from `step` on."""

    def end_run(self, n_ticks: int) -> None:
        """End the run after `n_ticks`."""

    def of_tick(self, tick: int, sensors: Floats) -> Floats:
        """Readings in a tick of the run, (steps, n), from all sensors (ticks, steps, nsensordata)."""
        rows: Floats = sensors[tick]
        return rows

    def meanwhile(self, landing: Landing, tick: int, planned: Floats, sensors: Floats) -> Iterable[Floats]:
        """Controls (12,) of the steps of a tick, in which a leg may stop while the sensors of the tick come."""
        return landing.controls(tick, planned, sensors[tick])

    def push_forces_n(self, tick: int, forces_n: Floats) -> Floats:
        """What a foot feels of its forces on the box in the ticks after `tick`, (n, 3)."""
        del tick
        return forces_n

    def pressing_n(self, tick: int, forces_n: Floats) -> Floats:
        """How hard any foot presses the box in the ticks after `tick`, (n,), by its forces there, (n, steps, 4, 3)."""
        del tick
        return _hardest_n(forces_n.mean(axis=1))

    def as_bytes(self) -> bytes:
        """All that later readings depend on, but the seed."""
        return b""


class OwnSenses:
    """IMU, encoders and foot forces of an episode, run by run. The rows of its readings are the physics steps."""

    forces, joints = FORCES, JOINTS
    """Columns of the vertical forces of the feet on their surroundings, and of the joint angles."""
    least_touch_n = 30.0
    """Least force by which a foot is known to be down. Our choice: a foot in the air seldom reads as much."""

    def __init__(self, reality: Reality, sensors: Sensors, first: Floats, gravity_m_s2: Floats) -> None:
        """Before anything has moved, the sensors read `first`, all sensors of the model."""
        felt = reality.senses
        self._gravity_m_s2 = gravity_m_s2.copy()
        self._velocity, self._orientation = sensors.of["imu_velocity"], sensors.of["imu_orientation"]
        self._seed = reality.seed
        self._sources = (
            (GYRO, sensors.of["imu_angular_velocity"]),
            (JOINTS, sensors.joint_positions),
            (FORCES, sensors.loads),
        )
        """Columns of the readings, and those of the sensors of the model."""
        self.late_steps = round(felt.latency_s / PHYSICS_STEP_S)
        """Age of a reading when it is given."""
        self._deviations, biases = np.zeros(N_READINGS), np.zeros(N_READINGS)
        for columns, noise, bias in (
            (GYRO, felt.gyro_noise_rad_s, felt.gyro_bias_rad_s),
            (ACCELERATION, felt.accelerometer_noise_m_s2, felt.accelerometer_bias_m_s2),
            (JOINTS, felt.encoder_noise_rad, 0.0),
            (FORCES, felt.force_noise_n, felt.force_bias_n),
        ):
            self._deviations[columns], biases[columns] = noise, bias
        for stream, columns in STREAMS:
            biases[columns] *= np.random.default_rng([self._seed, stream]).standard_normal(columns.stop - columns.start)
        self._biases = biases
        self._chunks: dict[int, Floats] = {}
        """Noise of the present chunks of ticks."""
        self._true = np.empty((self.late_steps, N_READINGS))
        """What a row of sensors without delay would have read: some steps before the run, and the run itself."""
        self._moved = np.empty((1, 7))
        """Velocity and orientation of the IMU in the world: in the step before the run, and in those of the run itself,
        (1 + steps, 7)."""
        self._moved[0, :3], self._moved[0, 3:] = first[self._velocity], first[self._orientation]
        for columns, source in self._sources:
            self._true[:, columns] = first[source]
        self._true[:, ACCELERATION] = _specific_forces(np.repeat(self._moved, 2, axis=0), gravity_m_s2)
        self._errors = np.empty((0, N_READINGS))
        self._read: Floats | None = None
        """Readings of the run as it is now, if they have been asked for."""
        self.last = np.empty((0, COMMANDS_PER_TICK, N_READINGS))
        """Readings of the last run, (ticks, steps, N_READINGS)."""
        self.tare_n = np.zeros(len(range(N_READINGS)[FORCES]))
        """What the foot forces are known to read too much, (4,)."""

    def begin_run(self, tick: int, n_ticks: int) -> None:
        """Begin a run of at most `n_ticks` after `tick`."""
        self._errors = self._biases + self._deviations * self._noise(tick, n_ticks)
        self._read = None
        past = self._true[: self.late_steps]
        self._true = np.empty((self.late_steps + n_ticks * COMMANDS_PER_TICK, N_READINGS))
        self._true[: self.late_steps] = past
        self._moved = np.concatenate([self._moved[:1], np.empty((n_ticks * COMMANDS_PER_TICK, 7))])

    def feel(self, step: int, sensors: Floats) -> None:
        """Take all sensors of the model, (n, nsensordata), in the steps of the run from `step` on."""
        n, self._read = len(sensors), None
        rows, moved = self._true[self.late_steps + step :][:n], self._moved[step + 1 :][:n]
        moved[:, :3], moved[:, 3:] = sensors[:, self._velocity], sensors[:, self._orientation]
        for columns, source in self._sources:
            rows[:, columns] = sensors[:, source]

    def of_tick(self, tick: int, sensors: Floats) -> Floats:
        """Joint angles and foot forces in a tick of the run, (steps, N_READINGS). Forces are without their tare."""
        del sensors
        return self._tared(tick * COMMANDS_PER_TICK, COMMANDS_PER_TICK)

    def meanwhile(self, landing: Landing, tick: int, planned: Floats, sensors: Floats) -> Iterator[Floats]:
        """Controls (12,) of the steps of a tick, in which a leg may stop while the sensors of the tick come."""
        readings, step = self.of_tick(tick, sensors), tick * COMMANDS_PER_TICK
        given = iter(landing.controls(tick, planned, readings))
        for k in range(COMMANDS_PER_TICK):
            if k > 0 and self.late_steps < COMMANDS_PER_TICK:
                self.feel(step + k - 1, sensors[tick, k - 1 : k])
                readings[k - 1] = self._tared(step + k - 1, 1)[0]
            yield next(given)

    def readings(self, n_ticks: int) -> Floats:
        """Readings in the first ticks of the run, (n_ticks, steps, N_READINGS)."""
        n = n_ticks * COMMANDS_PER_TICK
        if self._read is not None and len(self._read) == n_ticks:
            return self._read
        self._true[self.late_steps :][:n, ACCELERATION] = _specific_forces(self._moved[: n + 1], self._gravity_m_s2)
        self._read = (self._true[:n] + self._errors[:n]).reshape(n_ticks, COMMANDS_PER_TICK, N_READINGS)
        return self._read

    def _tared(self, step: int, n: int) -> Floats:
        readings: Floats = self._true[step : step + n] + self._errors[step : step + n]
        readings[:, FORCES] -= self.tare_n
        return readings

    def end_run(self, n_ticks: int) -> None:
        """End the run after `n_ticks`."""
        n = n_ticks * COMMANDS_PER_TICK
        self.last = self.readings(n_ticks)
        self._true = self._true[n : n + self.late_steps].copy()
        self._moved = self._moved[n : n + 1].copy()

    def push_forces_n(self, tick: int, forces_n: Floats) -> Floats:
        """What a foot feels of its forces on the box in the ticks after `tick`, (n, 3).

        The foot is in the air before, so that its sensor is tared, along all three axes.
        """
        felt: Floats = forces_n + self._push_noise_n(tick, len(forces_n))
        return felt

    def pressing_n(self, tick: int, forces_n: Floats) -> Floats:
        """How hard any foot presses the box as far as it is felt in the ticks after `tick`, (n,).

        Its forces there, (n, steps, 4, 3), are felt late: at first, that of the beginning.
        """
        steps = forces_n.reshape(-1, *forces_n.shape[2:])
        late = steps[np.maximum(np.arange(len(steps)) - self.late_steps, 0)].reshape(forces_n.shape)
        return _hardest_n(late.mean(axis=1) + self._push_noise_n(tick, len(forces_n))[:, None])

    def _push_noise_n(self, tick: int, n_ticks: int) -> Floats:
        """Noise of the mean force that a foot feels in each tick after `tick`, along all axes, (n_ticks, 3)."""
        deviation_n = float(self._deviations[FORCES].max()) / sqrt(COMMANDS_PER_TICK)
        first, last = tick // CHUNK_TICKS, (tick + n_ticks - 1) // CHUNK_TICKS
        chunks = [
            np.random.default_rng([self._seed, PUSH_STREAM, chunk]).standard_normal((CHUNK_TICKS, 3))
            for chunk in range(first, last + 1)
        ]
        scaled: Floats = deviation_n * np.concatenate(chunks)[tick - first * CHUNK_TICKS :][:n_ticks]
        return scaled

    def as_bytes(self) -> bytes:
        """All that later readings depend on, but the seed."""
        return b"".join(array.tobytes() for array in (self._true, self._moved, self.tare_n))

    def _noise(self, tick: int, n_ticks: int) -> Floats:
        """Standard normal numbers for the steps of `n_ticks` after `tick`, (steps, N_READINGS)."""
        first, last = tick // CHUNK_TICKS, (tick + n_ticks - 1) // CHUNK_TICKS
        self._chunks = {k: self._chunks[k] if k in self._chunks else self._chunk(k) for k in range(first, last + 1)}
        begin = (tick - first * CHUNK_TICKS) * COMMANDS_PER_TICK
        noise: Floats = np.concatenate(list(self._chunks.values()))[begin : begin + n_ticks * COMMANDS_PER_TICK]
        return noise

    def _chunk(self, chunk: int) -> Floats:
        noise = np.zeros((CHUNK_TICKS * COMMANDS_PER_TICK, N_READINGS))
        for stream, columns in STREAMS:
            if self._deviations[columns].any():
                generator = np.random.default_rng([self._seed, stream, FIRST_CHUNK + chunk])
                noise[:, columns] = generator.standard_normal((len(noise), columns.stop - columns.start))
        return noise


def _hardest_n(forces_n: Floats) -> Floats:
    """The largest of the forces of all feet in each tick, (n,), from (n, 4, 3)."""
    hardest: Floats = np.linalg.norm(forces_n, axis=-1).max(axis=-1)
    return hardest


def _specific_forces(moved: Floats, gravity_m_s2: Floats) -> Floats:
    """What an accelerometer reads in all steps but the first, (n, 3), with velocity and orientation (n + 1, 7) in each.

    It is the change of velocity in the step, without gravity, in the frame of the trunk at the end of the step.
    """
    force_x, force_y, force_z = (np.diff(moved[:, :3], axis=0) / PHYSICS_STEP_S - gravity_m_s2).T
    w, x, y, z = moved[1:, 3:].T
    # v' = v - 2 w (u x v) + 2 u x (u x v) turns into the frame of the trunk, with u = (x, y, z).
    cross_x, cross_y, cross_z = y * force_z - z * force_y, z * force_x - x * force_z, x * force_y - y * force_x
    forces = np.empty((len(moved) - 1, 3))
    forces[:, 0] = force_x - 2 * w * cross_x + 2 * (y * cross_z - z * cross_y)
    forces[:, 1] = force_y - 2 * w * cross_y + 2 * (z * cross_x - x * cross_z)
    forces[:, 2] = force_z - 2 * w * cross_z + 2 * (x * cross_y - y * cross_x)
    return forces


def senses_of(
    reality: Reality, sensors: Sensors, model: mujoco.MjModel, data: mujoco.MjData
) -> ExactSenses | OwnSenses:
    """The robot's own sensors in an episode that begins with `data`."""
    if reality.senses.exact:
        return ExactSenses(sensors)
    return OwnSenses(reality, sensors, data.sensordata, model.opt.gravity)
