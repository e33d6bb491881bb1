"""The motion of the robot as its own sensors tell it, tick by tick."""

import numpy as np

from legpush.arrays import Flags, Floats
from legpush.geometry import Pose2
from sim_proc.control.body_state import BodyState
from sim_proc.estimation import kernel, layout
from sim_proc.estimation.alignment import Begin, aligned

ROTATION, TIPS = slice(layout.OUT_ROTATION, layout.OUT_VELOCITY), slice(layout.OUT_TIPS, layout.OUT_LOADS)
POSITION, VELOCITY = slice(layout.OUT_POSITION, layout.OUT_ROTATION), slice(layout.OUT_VELOCITY, layout.OUT_RATE)
RATE, LOADS = slice(layout.OUT_RATE, layout.OUT_TIPS), slice(layout.OUT_LOADS, layout.OUT_COM)
COM, COM_VELOCITY = slice(layout.OUT_COM, layout.OUT_COM_VELOCITY), slice(layout.OUT_COM_VELOCITY, layout.OUT_JOINTS)
JOINTS = slice(layout.OUT_JOINTS, layout.N_OUT)
"""Columns of an estimate."""
TARE = slice(layout.TARE, layout.COM)


class Estimator:
    """Estimates the motion of one robot from imu, encoders and foot forces, in a frame that begins where it stands.

    Readings are some steps old when they come. What moves evenly, trunk and centre of mass, is told for the present;
    joints and feet are those of the readings.
    """

    def __init__(self, body: Floats, start: Pose2, still: Floats, late_steps: int) -> None:
        """Begin where the trunk is at `start`, after it stood still with readings (n, 22).

        `body` are the numbers of the robot, and `late_steps` is the age of the last reading when a tick ends.
        """
        self._body = body.copy()
        self._arrays, self._body[layout.GRAVITY : layout.GRAVITY + 3] = aligned(body, start, still)
        gravity = self._body[layout.GRAVITY : layout.GRAVITY + 3]
        self.downhill: Floats = gravity[:2] / -gravity[2]
        """Where a plumb line from one metre above the floor meets it, relative to the point below that, [m/m], (2,)."""
        self._age_s = late_steps * layout.STEP_S
        self._foreseen: tuple[Floats, Flags, Begin, Floats] | None = None
        """Readings, lifted feet, arrays and estimates of ticks that may be taken next."""
        self.rows: Floats = np.empty((0, layout.N_OUT))
        """Estimates after each tick that was taken last, (n, N_OUT), of the time of their readings."""
        self.advance(np.ascontiguousarray(still[-layout.STEPS :])[None], np.zeros((1, 4), dtype=np.bool_))

    def advance(self, readings: Floats, lifted: Flags) -> None:
        """Take n ticks with readings (n, steps, 22), and the feet that are lifted in them by plan, (n, 4)."""
        foreseen, self._foreseen = self._foreseen, None
        if foreseen and np.array_equal(foreseen[0], readings) and np.array_equal(foreseen[1], lifted):
            _, _, self._arrays, self.rows = foreseen
            return
        self.rows = np.empty((len(readings), layout.N_OUT))
        kernel.advance(*self._arrays, self._body, readings, lifted, self.rows)

    def foresee(self, readings: Floats, lifted: Flags) -> tuple[Floats, Floats, Floats]:
        """What may be known at the ends of ticks that may be taken next.

        The centre of mass and its velocity, (n, 3) each, and the centres of the feet, (n, 4, 3), of the time of their
        readings.
        """
        arrays, rows = Begin(*(array.copy() for array in self._arrays)), np.empty((len(readings), layout.N_OUT))
        kernel.advance(*arrays, self._body, readings, lifted, rows)
        self._foreseen = readings, lifted, arrays, rows
        velocities = rows[:, COM_VELOCITY]
        return rows[:, COM] + self._age_s * velocities, velocities, rows[:, TIPS].reshape(-1, 4, 3)

    def state(self) -> BodyState:
        """The motion at the end of the last tick."""
        row = self.rows[-1]
        velocity, rate, com_velocity = row[VELOCITY].copy(), row[RATE].copy(), row[COM_VELOCITY].copy()
        return BodyState(
            position_m=row[POSITION] + self._age_s * velocity,
            rotation=_turned(row[ROTATION].reshape(3, 3), self._age_s * rate),
            velocity_m_s=velocity,
            angular_velocity_rad_s=rate,
            tips_m=row[TIPS].reshape(4, 3).copy(),
            loads_n=row[LOADS].copy(),
            com_m=row[COM] + self._age_s * com_velocity,
            com_velocity_m_s=com_velocity,
        )

    def trunk_poses(self) -> Floats:
        """Poses of the trunk on the floor at the ends of the ticks that were taken last, (n, 3): x, y and heading."""
        rows, age_s = self.rows, self._age_s
        xy = rows[:, POSITION][:, :2] + age_s * rows[:, VELOCITY][:, :2]
        heading = np.arctan2(rows[:, layout.OUT_ROTATION + 3], rows[:, layout.OUT_ROTATION])
        return np.column_stack([xy, heading + age_s * rows[:, RATE][:, 2]])

    def joints_rad(self) -> Floats:
        """The last joint angles that were read, (12,)."""
        joints: Floats = self.rows[-1, JOINTS].copy()
        return joints

    @property
    def tare_n(self) -> Floats:
        """What the foot forces are found to read too much, (4,)."""
        too_much: Floats = -self._arrays.memory[TARE]
        return too_much

    def as_bytes(self) -> bytes:
        """All that later estimates depend on, but the readings and the robot."""
        return b"".join(array.tobytes() for array in (*self._arrays, self.rows[-1]))


def _turned(rotation: Floats, by: Floats) -> Floats:
    """A rotation (3, 3) that a small rotation vector (3,) in the outer frame turned on, up to second order."""
    x, y, z = by.tolist()
    skew = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    turned: Floats = (np.eye(3) + skew + skew @ skew / 2) @ rotation
    return turned
