"""What is filmed of a recorded episode: which ticks, from which camera, with which marks on the floor."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from legpush.episode import PlanRecord, StepRecord
from legpush.errors import JournalError
from legpush.geometry import rpy_from_quaternion
from legpush.messages.stepping import Appearance, Follow, Reset
from legpush.robot import CONTROL_PERIOD_S
from legpush.scenario import Scenario
from sim_proc.world_state import LOADED_N

Array = NDArray[np.float64]

SMOOTHING_S: Final = 3.0
"""The camera follows the robot's place and heading averaged over this long."""


@dataclass(frozen=True, kw_only=True)
class Footprint:
    """Where a foot came down, from a tick on."""

    tick: int
    position_m: Array
    front: bool


@dataclass(frozen=True, kw_only=True)
class Film:
    """An episode, ready to be filmed."""

    scenario: Scenario
    qpos: Array
    """(n, 26), one row per tick."""
    trunk_m: Array
    """The robot's smoothed place, (n, 2)."""
    heading_rad: Array
    """The robot's smoothed heading, (n,)."""
    paths_m: list[tuple[int, Array]]
    """Paths by the tick from which they are followed, each (k, 2)."""
    footprints: list[Footprint]
    hidden_until: dict[int, int | None]
    """By the place of an obstacle that appears later: the row of `qpos` from which it is seen, None for never."""

    @property
    def duration_s(self) -> float:
        """Simulated time."""
        return len(self.qpos) * CONTROL_PERIOD_S


def film_of(records: Iterable[StepRecord | PlanRecord], where: str) -> Film:
    """Read the records of one episode; `JournalError` names `where` if nothing in them was traced."""
    scenario: Scenario | None = None
    rows: list[Array] = []
    tips: list[Array] = []
    loads: list[Array] = []
    paths: list[tuple[int, Array]] = []
    appeared: tuple[Appearance, ...] = ()
    n_ticks = 0
    for record in records:
        if not isinstance(record, StepRecord):
            continue
        if isinstance(record.motion, Reset):
            scenario = record.motion.scenario
        if isinstance(record.motion, Follow):
            paths.append((n_ticks, np.array([[p.x_m, p.y_m] for p in record.motion.waypoints])))
        appeared = record.outcome.world.appeared
        trace = record.outcome.trace
        if trace is not None and trace.tick:
            rows.append(np.array(trace.qpos))
            tips.append(np.array(trace.tips_m))
            loads.append(np.linalg.norm(trace.contact_forces_n, axis=2))
            n_ticks += len(trace.tick)
    if scenario is None or not rows:
        raise JournalError(f"{where}: expected an episode recorded with traces, got none that moves")
    qpos = np.concatenate(rows)
    yaw = np.unwrap(rpy_from_quaternion(qpos[:, 3:7])[:, 2])
    return Film(
        scenario=scenario,
        qpos=qpos,
        trunk_m=np.column_stack([_smooth(qpos[:, 0]), _smooth(qpos[:, 1])]),
        heading_rad=_smooth(yaw),
        paths_m=paths,
        footprints=_footprints(np.concatenate(tips), np.concatenate(loads)),
        hidden_until=_hidden_until(scenario, appeared),
    )


def _hidden_until(scenario: Scenario, appeared: tuple[Appearance, ...]) -> dict[int, int | None]:
    """The first row is the end of tick 1."""
    rows = {each.obstacle: each.tick - 1 for each in appeared}
    later = (index for index, obstacle in enumerate(scenario.room.obstacles) if obstacle.appears_at_s > 0.0)
    return {index: rows.get(index) for index in later}


def _footprints(tips_m: Array, forces_n: Array) -> list[Footprint]:
    """Where each foot begins to carry load."""
    loaded = forces_n >= LOADED_N
    landed = loaded[1:] & ~loaded[:-1] & (tips_m[1:, :, 2] < 2 * tips_m[0, :, 2].max())
    return [
        Footprint(tick=int(tick) + 1, position_m=tips_m[tick + 1, leg, :2], front=leg < 2)
        for tick, leg in np.argwhere(landed)
    ]


def _smooth(values: Array) -> Array:
    """A centred moving average with a raised-cosine window, held at the ends, (n,)."""
    half = round(SMOOTHING_S / CONTROL_PERIOD_S / 2)
    window = np.hanning(2 * half + 3)[1:-1]
    padded = np.concatenate([np.full(half, values[0]), values, np.full(half, values[-1])])
    return np.convolve(padded, window / window.sum(), mode="valid")
