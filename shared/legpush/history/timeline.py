"""An episode as it can be looked at: its steps, and a row of numbers for each tick, in arrays that grow."""

from bisect import bisect_right
from dataclasses import dataclass
from math import nan
from typing import Final

import numpy as np

from legpush.arrays import Floats, Indices
from legpush.geometry import rpy_from_quaternion
from legpush.messages.stepping import Motion, Outcome, Trace, WorldState
from legpush.realism.reality import AS_ASSUMED
from legpush.scene.conventions import BOX_QPOS, CONTROL_PERIOD_S, JOINT_QPOS, LEG_JOINTS, N_QPOS, TRUNK_QPOS
from legpush.scene.scenario import Scenario

TRUNK: Final = TRUNK_QPOS
JOINTS: Final = JOINT_QPOS
BOX: Final = BOX_QPOS
"""Columns of `Timeline.qpos`."""
COLUMNS: Final[dict[str, tuple[int, ...]]] = {
    "tick": (),
    "qpos": (N_QPOS,),
    "roll_pitch_rad": (2,),
    "tips_m": (4, 3),
    "contact_forces_n": (4, 3),
    "com_m": (3,),
    "zmp_m": (2,),
    "support_margin_m": (),
}
"""Shapes of a row of the fields that every trace has."""
LATER_COLUMNS: Final[dict[str, tuple[int, ...]]] = {
    "zmp_margin_m": (),
    "capture_margin_m": (),
    "foot_moment_n_m": (3,),
    "joint_velocities_rad_s": (len(LEG_JOINTS),),
    "joint_torques_n_m": (len(LEG_JOINTS),),
    "trunk_velocity_m_s": (3,),
    "imu_angular_velocity_rad_s": (3,),
    "imu_acceleration_m_s2": (3,),
}
"""Shapes of a row of the fields that are empty before protocol 8."""


@dataclass(frozen=True, kw_only=True)
class TimelineStep:
    """A step that was carried out, and the rows that it led to."""

    number: int
    motion: Motion
    world: WorldState
    """At its end."""
    first_row: int
    n_rows: int
    """0 where it took no time."""
    time_ns: int
    """When it was answered, since 1970."""


class Timeline:
    """One episode; row 0 is its state after the first step that is known, and each further row is a later tick.

    A step without a trace has one row, for its end, with NaN for what only a trace has.
    """

    def __init__(self, scenario: Scenario) -> None:
        """Empty; `scenario` is that of its reset."""
        self.scenario = scenario
        self.reality = AS_ASSUMED
        """What the seed drew from `realism`, once the outcome of the reset is known."""
        self.steps: list[TimelineStep] = []
        self.rewards: dict[int, float] = {}
        """By the number of the step that earned it."""
        self._columns = {name: _Column(shape) for name, shape in {**COLUMNS, **LATER_COLUMNS}.items()}

    def add(self, number: int, motion: Motion, outcome: Outcome, time_ns: int) -> None:
        """The next step was carried out."""
        first_row, trace = self.n_rows, outcome.trace
        self.reality = outcome.reality or self.reality
        if trace is not None and trace.tick:
            self._extend(trace)
        elif not self.n_rows or outcome.world.tick > self.tick[-1]:
            self._append(outcome.world)
        self.steps.append(
            TimelineStep(
                number=number,
                motion=motion,
                world=outcome.world,
                first_row=first_row,
                n_rows=self.n_rows - first_row,
                time_ns=time_ns,
            )
        )

    @property
    def n_rows(self) -> int:
        """Ticks that are known."""
        return self._columns["tick"].n

    @property
    def tick(self) -> Floats:
        """Control periods since the reset, (n,)."""
        return self._columns["tick"].view()

    @property
    def time_s(self) -> Floats:
        """Simulated time since the reset, (n,)."""
        return self.tick * CONTROL_PERIOD_S

    @property
    def qpos(self) -> Floats:
        """MuJoCo's generalized positions, (n, 26): `TRUNK`, `JOINTS`, `BOX`."""
        return self._columns["qpos"].view()

    @property
    def roll_pitch_rad(self) -> Floats:
        """Of the trunk, (n, 2)."""
        return self._columns["roll_pitch_rad"].view()

    @property
    def tips_m(self) -> Floats:
        """Centres of the foot spheres FL, FR, RL, RR, world frame, (n, 4, 3)."""
        return self._columns["tips_m"].view()

    @property
    def contact_forces_n(self) -> Floats:
        """Of floor and box together on each foot, world frame, (n, 4, 3)."""
        return self._columns["contact_forces_n"].view()

    @property
    def com_m(self) -> Floats:
        """Of the robot, world frame, (n, 3)."""
        return self._columns["com_m"].view()

    @property
    def zmp_m(self) -> Floats:
        """On the floor, (n, 2)."""
        return self._columns["zmp_m"].view()

    @property
    def support_margin_m(self) -> Floats:
        """Signed distance of the CoM's ground projection to the border of the support polygon, inside positive."""
        return self._columns["support_margin_m"].view()

    @property
    def zmp_margin_m(self) -> Floats:
        """The same distance for the zero-moment point, (n,). This and what follows is NaN before protocol 8."""
        return self._columns["zmp_margin_m"].view()

    @property
    def capture_margin_m(self) -> Floats:
        """The same distance for the capture point, (n,)."""
        return self._columns["capture_margin_m"].view()

    @property
    def foot_moment_n_m(self) -> Floats:
        """Moment of all forces on the feet about the centre of mass, world frame, (n, 3)."""
        return self._columns["foot_moment_n_m"].view()

    @property
    def joint_velocities_rad_s(self) -> Floats:
        """Speeds of the joints, (n, 12)."""
        return self._columns["joint_velocities_rad_s"].view()

    @property
    def joint_torques_n_m(self) -> Floats:
        """Torques of the servos, (n, 12)."""
        return self._columns["joint_torques_n_m"].view()

    @property
    def trunk_velocity_m_s(self) -> Floats:
        """Velocity of the middle of the trunk, world frame, (n, 3)."""
        return self._columns["trunk_velocity_m_s"].view()

    @property
    def imu_angular_velocity_rad_s(self) -> Floats:
        """What the gyroscope reads without noise, frame of the trunk, (n, 3)."""
        return self._columns["imu_angular_velocity_rad_s"].view()

    @property
    def imu_acceleration_m_s2(self) -> Floats:
        """What the accelerometer reads without noise, frame of the trunk, (n, 3)."""
        return self._columns["imu_acceleration_m_s2"].view()

    def box_error(self, rows: slice | Indices = slice(None)) -> Floats:
        """Distance of the box from its goal [m] and the angle between their headings [rad], in [0, pi], (n, 2)."""
        pose = self.scenario.goal.pose.pose()
        box = self.qpos[rows, BOX]
        yaw = rpy_from_quaternion(box[:, 3:])[:, 2] - pose.yaw_rad
        away = np.hypot(box[:, 0] - pose.x_m, box[:, 1] - pose.y_m)
        return np.column_stack([away, np.abs((yaw + np.pi) % (2 * np.pi) - np.pi)])

    def step_at(self, row: int) -> TimelineStep:
        """The step that led to a row: of those that end there, the last."""
        return self.steps[self.step_index_at(row)]

    def step_index_at(self, row: int) -> int:
        """Where `step_at` is among the steps."""
        return bisect_right(self.steps, row, key=lambda step: step.first_row) - 1

    def rows_at(self, ticks: Floats) -> Indices:
        """The last row up to each tick, or the first one there is."""
        rows: Indices = np.maximum(np.searchsorted(self.tick, ticks, side="right") - 1, 0)
        return rows

    def row_at(self, time_ns: int) -> int:
        """The last row that was known at a time since 1970."""
        done = bisect_right(self.steps, time_ns, key=lambda step: step.time_ns)
        return max(0, (self.steps[done].first_row if done < len(self.steps) else self.n_rows) - 1)

    def time_ns_at(self, row: int) -> int:
        """When a row was computed, since 1970: a step's rows are spread between the answer before and its own."""
        index = self.step_index_at(row)
        step = self.steps[index]
        began = self.steps[index - 1].time_ns if index else step.time_ns
        share = (row - step.first_row + 1) / max(step.n_rows, 1)
        return began + round(share * (step.time_ns - began))

    def _extend(self, trace: Trace) -> None:
        for name, column in self._columns.items():
            rows = getattr(trace, name)
            if not rows:
                rows = np.full((len(trace.tick), *LATER_COLUMNS[name]), nan)
            column.extend(np.array(rows, dtype=np.float64))

    def _append(self, world: WorldState) -> None:
        trunk, box = world.trunk, world.box
        qpos = (
            *trunk.position_m,
            *trunk.orientation_wxyz,
            *world.joint_positions_rad,
            *box.position_m,
            *box.orientation_wxyz,
        )
        row = {
            "tick": world.tick,
            "qpos": qpos,
            "roll_pitch_rad": rpy_from_quaternion(np.array(trunk.orientation_wxyz)[None])[0, :2],
            "tips_m": world.tips_m,
            "joint_velocities_rad_s": world.joint_velocities_rad_s,
            "trunk_velocity_m_s": trunk.linear_velocity_m_s,
            "imu_angular_velocity_rad_s": world.imu.angular_velocity_rad_s,
            "imu_acceleration_m_s2": world.imu.linear_acceleration_m_s2,
        }
        for name, column in self._columns.items():
            shape = column.view().shape[1:]
            column.extend(np.broadcast_to(np.asarray(row.get(name, nan), dtype=np.float64), shape)[None])


def is_whole(trace: Trace) -> bool:
    """Whether it has a whole row for each of its ticks, with or without all that is empty before protocol 8."""
    n_ticks = len(trace.tick)
    later = {len(getattr(trace, name)) for name in LATER_COLUMNS}
    return (
        all(len(getattr(trace, name)) == n_ticks for name in COLUMNS)
        and later in ({n_ticks}, {0})
        and all(len(row) == BOX.stop for row in trace.qpos)
        and all(len(row) == len(LEG_JOINTS) for row in (*trace.joint_velocities_rad_s, *trace.joint_torques_n_m))
    )


class _Column:
    """An array that grows at its end."""

    def __init__(self, shape: tuple[int, ...]) -> None:
        self.n = 0
        self._rows = np.empty((64, *shape))

    def extend(self, rows: Floats) -> None:
        n = self.n + len(rows)
        if n > len(self._rows):
            grown = np.empty((max(n, 2 * len(self._rows)), *self._rows.shape[1:]))
            grown[: self.n] = self._rows[: self.n]
            self._rows = grown
        self._rows[self.n : n] = rows
        self.n = n

    def view(self) -> Floats:
        """What is there, read-only, as later rows do not change it."""
        view = self._rows[: self.n]
        view.flags.writeable = False
        return view
