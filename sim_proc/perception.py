"""How robot and box are perceived: poses that are measured with noise, at a rate, late, and not always.

All looks at the box are filtered."""

import struct
from dataclasses import dataclass
from math import ceil, cos, inf, radians, sin
from statistics import NormalDist
from typing import Final, NamedTuple

import numpy as np

from legpush.arrays import Floats
from legpush.geometry import Pose2
from legpush.messages.stepping import BoxState, Perceived
from legpush.realism.reality import BOX_STREAM, LOCALIZATION_STREAM, Reality, Sensed
from legpush.scene.conventions import BOX_QPOS, CONTROL_PERIOD_S, TRUNK_QPOS
from legpush.scene.scenario import Box
from sim_proc.box_filter import BoxFilter

CHUNK: Final = 32
"""Number of measurements whose noise comes from one generator."""
ROUNDING_TICKS: Final = 1e-6
"""A time this close above a whole number of ticks counts as that number."""


class Fix(NamedTuple):
    """A pose of the trunk in the world that was measured."""

    tick: int
    given_tick: int
    """From when on it is known."""
    pose: Pose2


@dataclass(frozen=True, kw_only=True)
class Measurement:
    """The pose of a body that was measured."""

    tick: int
    """When it was made."""
    given_tick: int
    """From when on it is known."""
    true: Floats
    """Position and quaternion of the body then, (7,)."""
    error: Pose2
    """What the noise adds to x, y and heading."""
    n_moving: int
    """Number of ticks up to then in which the body may have moved."""

    @property
    def seen(self) -> Pose2:
        """What was measured, projected to the floor."""
        return planar(_turned(self.true, self.error))


class PoseSensor:
    """Measures the pose of one body, tick by tick."""

    def __init__(self, sensed: Sensed, seed: int, stream: int, first: Floats) -> None:
        """Measure the pose of tick 0, (7,), which is known at once."""
        self._sensed, self._seed, self._stream = sensed, seed, stream
        self._period_ticks = 1.0 / (sensed.rate_hz * CONTROL_PERIOD_S)
        self.late_ticks = ceil(sensed.latency_s / CONTROL_PERIOD_S - ROUNDING_TICKS)
        """Age of a measurement when it becomes known."""
        self._lost_below = NormalDist().inv_cdf(sensed.dropouts) if sensed.dropouts > 0.0 else -inf
        """A measurement is lost if its fourth random number is below this quantile."""
        self._chunk, self._drawn = -1, list[list[float]]()
        """The number of the chunk of measurements whose random numbers were drawn last, and these numbers."""
        self._n_made = 0
        """Number of measurements that were made, or lost."""
        self._next_tick = 0
        self._coming: list[Measurement] = []
        """Those that are not known yet, the oldest first."""
        self.known = self._measured(0, first, late_ticks=0, n_moving=0)
        """The last one that is known."""
        self._count()

    @property
    def next_change(self) -> int:
        """The next tick at whose end a measurement is made or becomes known."""
        return min(self._next_tick, self._coming[0].given_tick) if self._coming else self._next_tick

    def pass_tick(self, tick: int, true: Floats, n_moving: int = 0) -> bool:
        """Measure at the end of a tick, when the body is at `true`, (7,); returns whether something new is known."""
        if tick >= self._next_tick:
            if not self._is_lost():
                self._coming.append(self._measured(tick, true, self.late_ticks, n_moving))
            self._count()
        is_new = False
        while self._coming and self._coming[0].given_tick <= tick:
            self.known, is_new = self._coming.pop(0), True
        return is_new

    def _count(self) -> None:
        self._n_made += 1
        self._next_tick = ceil(self._n_made * self._period_ticks - ROUNDING_TICKS)

    def _is_lost(self) -> bool:
        return self._draw()[3] < self._lost_below

    def _draw(self) -> list[float]:
        """Four standard normal numbers of the next measurement. Some measurements share a generator."""
        chunk, row = divmod(self._n_made, CHUNK)
        if chunk != self._chunk:
            generator = np.random.default_rng([self._seed, self._stream, chunk])
            self._chunk, self._drawn = chunk, generator.standard_normal((CHUNK, 4)).tolist()
        return self._drawn[row]

    def _measured(self, tick: int, true: Floats, late_ticks: int, n_moving: int) -> Measurement:
        sensed = self._sensed
        x, y, turn, _ = self._draw()
        return Measurement(
            tick=tick,
            given_tick=tick + late_ticks,
            true=true.copy(),
            error=Pose2(x_m=sensed.noise_m * x, y_m=sensed.noise_m * y, yaw_rad=radians(sensed.noise_deg) * turn),
            n_moving=n_moving,
        )

    def as_bytes(self) -> bytes:
        """All that later measurements depend on, but the seed."""
        rows = [
            struct.pack("<3q", one.tick, one.given_tick, one.n_moving)
            + struct.pack("<10d", *one.true, one.error.x_m, one.error.y_m, one.error.yaw_rad)
            for one in (self.known, *self._coming)
        ]
        return struct.pack("<2q", self._n_made, self._next_tick) + b"".join(rows)


class Perception:
    """What is known of robot and box. Where that is exact, truth is given."""

    def __init__(self, reality: Reality, qpos: Floats, box: Box) -> None:
        """Begin at tick 0 with `qpos` (26,), beside a box whose size is known."""

        def sensor(sensed: Sensed, stream: int, columns: slice) -> PoseSensor | None:
            return None if sensed.exact else PoseSensor(sensed, reality.seed, stream, qpos[columns])

        self._box = sensor(reality.box_pose, BOX_STREAM, BOX_QPOS)
        self._trunk = sensor(reality.localization, LOCALIZATION_STREAM, TRUNK_QPOS)
        self._fixes: list[Fix] = []
        """Localizations that became known in the ticks that were taken last."""
        self._filter = None if self._box is None else BoxFilter(box, reality.box_pose, self._box.known.seen)

    @property
    def exact(self) -> bool:
        """Whether everything is known as it is."""
        return self._box is None and self._trunk is None

    def take(self, first_tick: int, qpos: Floats, tips_m: Floats) -> None:
        """Measure at the ends of ticks from `first_tick` on, with `qpos` (n, 26) and feet at `tips_m` (n, 4, 3)."""
        end = first_tick + len(qpos)
        if self._box is not None and self._filter is not None:
            tick = first_tick
            while (change := max(self._box.next_change, tick)) < end:
                self._filter.pass_ticks(tips_m[tick - first_tick : change - first_tick + 1])
                if self._box.pass_tick(change, qpos[change - first_tick, BOX_QPOS], self._filter.n_moving):
                    self._filter.look(self._box.known.seen, self._box.known.n_moving)
                tick = change + 1
            self._filter.pass_ticks(tips_m[tick - first_tick :])
        if self._trunk is not None:
            self._fixes, tick = [], first_tick
            while (change := max(self._trunk.next_change, tick)) < end:
                if self._trunk.pass_tick(change, qpos[change - first_tick, TRUNK_QPOS]):
                    self._fixes.append(_fix(self._trunk.known))
                tick = change + 1

    def box(self, qpos: Floats) -> Floats:
        """Position and quaternion of the box as it is known, (7,), from the true `qpos` (26,)."""
        if self._box is None or self._filter is None:
            pose: Floats = qpos[BOX_QPOS]
            return pose
        true, known = self._box.known.true, self._filter.pose
        at = planar(true)
        off = Pose2(x_m=known.x_m - at.x_m, y_m=known.y_m - at.y_m, yaw_rad=known.yaw_rad - at.yaw_rad)
        return _turned(true, off)

    def box_tick(self, tick: int) -> int:
        """When the box was measured, if it is known at a tick."""
        return tick if self._box is None else self._box.known.tick

    def first_fix(self) -> Fix | None:
        """The first localization of the robot; None if it is always known where it is."""
        return None if self._trunk is None else _fix(self._trunk.known)

    def fixes(self) -> tuple[list[Fix], int]:
        """Localizations that became known in the ticks that were taken last, and their age in ticks then."""
        return (self._fixes, 0) if self._trunk is None else (self._fixes, self._trunk.late_ticks)

    def place_of_world(self) -> Pose2 | None:
        """Pose of the world's frame, as the robot is located in it, in the true one; None if they are the same."""
        if self._trunk is None:
            return None
        known = self._trunk.known
        return planar(known.true) @ known.seen.inverse()

    def perceived(self, qpos: Floats, tick: int) -> Perceived | None:
        """What is known at a tick, from the true `qpos` (26,); None if everything is known as it is."""
        if self.exact:
            return None
        trunk, place = planar(qpos[TRUNK_QPOS]), self.place_of_world()
        box = self.box(qpos).tolist()
        return Perceived(
            trunk=trunk if place is None else place.inverse() @ trunk,
            trunk_tick=tick if self._trunk is None else self._trunk.known.tick,
            box=BoxState(position_m=tuple(box[:3]), orientation_wxyz=tuple(box[3:])),
            box_tick=self.box_tick(tick),
        )

    def as_bytes(self) -> bytes:
        """All that later perception depends on, but the seed."""
        parts = self._box, self._filter, self._trunk
        return b"".join(part.as_bytes() for part in parts if part is not None)


def _fix(measured: Measurement) -> Fix:
    return Fix(tick=measured.tick, given_tick=measured.given_tick, pose=measured.seen)


def planar(pose: Floats) -> Pose2:
    """A position and quaternion (7,), projected to the floor."""
    x, y, _, qw, qx, qy, qz = (float(value) for value in pose)
    return Pose2(x_m=x, y_m=y, yaw_rad=float(np.arctan2(2 * (qw * qz + qx * qy), 1 - 2 * (qy * qy + qz * qz))))


def _turned(pose: Floats, error: Pose2) -> Floats:
    """A pose (7,) that is moved over the floor and turned about the vertical by an error."""
    x, y, z, qw, qx, qy, qz = pose.tolist()
    c, s = cos(error.yaw_rad / 2), sin(error.yaw_rad / 2)
    return np.array(
        [
            x + error.x_m,
            y + error.y_m,
            z,
            c * qw - s * qz,
            c * qx - s * qy,
            c * qy + s * qx,
            c * qz + s * qw,
        ]
    )
