"""The contents of a film of an episode: its ticks, the marks on the floor, and the places that cameras follow."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final

import numpy as np

from legpush.arrays import Floats
from legpush.errors import JournalError, RecordingError
from legpush.geometry import rpy_from_quaternion
from legpush.history.steps import PlanRecord, StepRecord
from legpush.history.timeline import BOX, TRUNK, Timeline, TimelineStep
from legpush.messages.stepping import Follow, Motion, Push, Reset, Walk
from legpush.realism.reality import Reality
from legpush.scene.conventions import CONTROL_PERIOD_S, LOADED_N
from legpush.scene.scenario import Scenario

SMOOTHING_S: Final = 3.0
"""Window over which the places and headings that cameras follow are averaged."""
STANDING: Final = "standing"
"""The phase before the robot walks or pushes."""


@dataclass(frozen=True, kw_only=True)
class FootMark:
    """The mark of a foot that came down, shown from a row on."""

    row: int
    position_m: Floats
    front: bool


@dataclass(frozen=True, kw_only=True)
class Film:
    """An episode, ready to be filmed, with one row for every tick."""

    scenario: Scenario
    reality: Reality
    """What the robot was not told, such as tiles."""
    first_tick: int
    """Tick of row 0."""
    qpos: Floats
    """(n, 26)"""
    trunk_m: Floats
    """The robot's smoothed place, (n, 2)."""
    heading_rad: Floats
    """The robot's smoothed heading, (n,)."""
    box_m: Floats
    """The box's smoothed place, (n, 2)."""
    box_heading_rad: Floats
    """The box's smoothed heading, (n,)."""
    paths_m: list[tuple[int, Floats]]
    """Paths by the row from which they are followed, each (k, 2)."""
    footprints: list[FootMark]
    phases: list[tuple[int, str]]
    """What the robot does, by the row from which it does that."""
    hidden_until: dict[int, int | None]
    """For each obstacle that appears later, by its index: the row from which it is seen; None if it never is."""

    @property
    def duration_s(self) -> float:
        """Simulated time from the first to the last row."""
        return (len(self.qpos) - 1) * CONTROL_PERIOD_S


def timeline_of(records: Iterable[StepRecord | PlanRecord], where: str) -> Timeline:
    """The timeline of the last episode in the records of one journal.

    Raises:
        JournalError: There is no reset among the records; names `where` they are from.
    """
    timeline: Timeline | None = None
    n_steps = 0
    for record in records:
        if isinstance(record, StepRecord):
            if isinstance(record.motion, Reset):
                timeline = Timeline(record.motion.scenario)
            if timeline is not None:
                timeline.add(n_steps, record.motion, record.outcome, 0)
            n_steps += 1
    if timeline is None:
        raise JournalError(f"{where}: expected an episode recorded with traces, got one without a reset")
    return timeline


def film_of(timeline: Timeline, where: str, *, still: bool = False) -> Film:
    """Prepare a timeline to be filmed.

    While ticks are missing, as in steps without a trace, the film stands still. For a `still`, no step needs a trace.

    Raises:
        RecordingError: No step of the episode has a trace; names `where` the episode is from.
    """
    if not still and not np.isfinite(timeline.com_m).any():
        raise RecordingError(f"{where}: expected an episode recorded with traces, got one without traces")
    ticks = timeline.tick.astype(int)
    rows = np.searchsorted(ticks, np.arange(ticks[0], ticks[-1] + 1), side="right") - 1
    qpos = timeline.qpos[rows]
    trunk, box = qpos[:, TRUNK], qpos[:, BOX]
    forces = np.linalg.norm(timeline.contact_forces_n[rows], axis=2)
    return Film(
        scenario=timeline.scenario,
        reality=timeline.reality,
        first_tick=int(ticks[0]),
        qpos=qpos,
        trunk_m=_smooth_place(trunk),
        heading_rad=_smooth_heading(trunk),
        box_m=_smooth_place(box),
        box_heading_rad=_smooth_heading(box),
        paths_m=[
            (
                int(ticks[min(step.first_row, len(ticks) - 1)] - ticks[0]),
                np.array([[point.x_m, point.y_m] for point in step.motion.waypoints]),
            )
            for step in timeline.steps
            if isinstance(step.motion, Follow)
        ],
        footprints=_footprints(timeline.tips_m[rows], forces),
        phases=[(int(ticks[min(row, len(ticks) - 1)] - ticks[0]), phase) for row, phase in _phases_of(timeline.steps)],
        hidden_until=_hidden_until(timeline, int(ticks[0])),
    )


def _hidden_until(timeline: Timeline, first_tick: int) -> dict[int, int | None]:
    """The row from which each obstacle that appears later is seen."""
    rows = {each.obstacle: max(0, each.tick - first_tick) for each in timeline.steps[-1].world.appeared}
    obstacles = enumerate(timeline.scenario.room.obstacles)
    return {index: rows.get(index) for index, obstacle in obstacles if obstacle.appears_at_s > 0.0}


def _footprints(tips_m: Floats, forces_n: Floats) -> list[FootMark]:
    """The places where feet begin to carry load. A foot whose force is unknown counts as loaded all the time."""
    loaded = ~(forces_n < LOADED_N)
    landed = loaded[1:] & ~loaded[:-1] & (tips_m[1:, :, 2] < 2 * tips_m[0, :, 2].max())
    return [
        FootMark(row=int(row) + 1, position_m=tips_m[row + 1, leg, :2], front=leg < 2)
        for row, leg in np.argwhere(landed)
    ]


def _smooth_place(pose: Floats) -> Floats:
    return np.column_stack([_smooth(pose[:, 0]), _smooth(pose[:, 1])])


def _smooth_heading(pose: Floats) -> Floats:
    return _smooth(np.unwrap(rpy_from_quaternion(pose[:, 3:])[:, 2]))


def _smooth(values: Floats) -> Floats:
    """A centred moving average with a raised-cosine window, (n,). The values are extended by those at the ends."""
    half = round(SMOOTHING_S / CONTROL_PERIOD_S / 2)
    window = np.hanning(2 * half + 3)[1:-1]
    padded = np.concatenate([np.full(half, values[0]), values, np.full(half, values[-1])])
    return np.convolve(padded, window / window.sum(), mode="valid")


def _phase_of(motion: Motion, before: str) -> str:
    """Return the phase that a motion belongs to; one that moves nothing belongs to that before it."""
    if isinstance(motion, Walk | Follow):
        return "walking"
    return "pushing" if isinstance(motion, Push) else before


def _phases_of(steps: list[TimelineStep]) -> list[tuple[int, str]]:
    """Return each phase with the row of the timeline from which it lasts."""
    phases = [(0, STANDING)]
    for step in steps:
        phase = _phase_of(step.motion, phases[-1][1])
        if phase != phases[-1][1]:
            phases.append((step.first_row, phase))
    return phases
