"""The time series of episodes as columns with one row per tick. Names of columns hold unit and frame."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from legpush.arrays import Floats
from legpush.history.timeline import BOX, JOINTS, TRUNK, Timeline
from legpush.scene.conventions import LEG_JOINTS, LEGS
from sim_proc.export.source import Exported

XYZ: Final = ("x", "y", "z")
UNITS: Final = {"_n_m": "N m", "_m_s2": "m/s^2", "_m_s": "m/s", "_rad_s": "rad/s", "_m": "m", "_rad": "rad", "_n": "N"}
"""Endings of names of columns, with their units: the longer ones first."""
POSE: Final = (*(f"{axis}_w_m" for axis in XYZ), *(f"q{part}_w" for part in ("w", "x", "y", "z")))


@dataclass(frozen=True, kw_only=True)
class Column:
    """A quantity with one value per row."""

    name: str
    unit: str
    """Symbol of the SI unit; empty for counts, words and numbers without a unit."""
    about: str
    """What the quantity is, in a few words."""
    values: NDArray[np.generic]
    """(n,): floats with NaN for unknown values, integers, or words."""


def columns_of(episodes: Sequence[Exported]) -> list[Column]:
    """The columns of episodes, whose rows follow one another."""
    each = [list(_columns(episode)) for episode in episodes]
    return [
        Column(
            name=parts[0].name,
            unit=parts[0].unit,
            about=parts[0].about,
            values=np.concatenate([part.values for part in parts]),
        )
        for parts in zip(*each, strict=True)
    ]


def _columns(episode: Exported) -> Iterator[Column]:
    """The columns of one episode."""
    timeline = episode.timeline
    n = timeline.n_rows
    steps = [step for step in timeline.steps if step.n_rows]
    n_rows = [step.n_rows for step in steps]
    yield _column("episode", "", "index of the episode, as in `legpush info`", np.full(n, episode.index))
    yield _column("sim", "", "name of the simulator", np.full(n, episode.sim))
    yield _column(
        "step", "", "number of the step that led to this row", np.repeat([step.number for step in steps], n_rows)
    )
    yield _column(
        "motion", "", "kind of motion of that step", np.repeat([_kind(step.motion) for step in steps], n_rows)
    )
    yield _column("tick", "", "control periods of 0.02 s since the reset", timeline.tick.astype(np.int64))
    yield _column("time_s", "s", "simulated time since the reset", timeline.time_s)
    yield from _named("trunk", POSE, "pose of the trunk", timeline.qpos[:, TRUNK])
    yield from _named(
        "trunk", ("roll_rad", "pitch_rad"), "angle of the trunk against the floor", timeline.roll_pitch_rad
    )
    for prefix, ending, about, values in (
        ("trunk_velocity", "w_m_s", "velocity of the middle of the trunk", timeline.trunk_velocity_m_s),
        ("imu_rate", "b_rad_s", "reading of the gyroscope without noise", timeline.imu_angular_velocity_rad_s),
        ("imu_acceleration", "b_m_s2", "reading of the accelerometer without noise", timeline.imu_acceleration_m_s2),
    ):
        yield from _named(prefix, [f"{axis}_{ending}" for axis in XYZ], about, values)
    for about, unit, values in (
        ("angle of a joint", "rad", timeline.qpos[:, JOINTS]),
        ("speed of a joint", "rad_s", timeline.joint_velocities_rad_s),
        ("torque of a servo", "n_m", timeline.joint_torques_n_m),
    ):
        yield from _named("joint", [f"{name}_{unit}" for name in LEG_JOINTS], about, values)
    yield from _named("box", POSE, "pose of the box's centre", timeline.qpos[:, BOX])
    error = timeline.box_error()
    yield from _named(
        "box_error", ("m", "rad"), "deviation of the box from the goal pose, in the plane of the floor", error
    )
    for leg, name in enumerate(LEGS):
        about = "centre of the foot sphere"
        yield from _named(f"tip_{name}", [f"{axis}_w_m" for axis in XYZ], about, timeline.tips_m[:, leg])
    for leg, name in enumerate(LEGS):
        about = "contact force of floor and box together on the foot"
        yield from _named(f"force_{name}", [f"{axis}_w_n" for axis in XYZ], about, timeline.contact_forces_n[:, leg])
    yield from _named("com", [f"{axis}_w_m" for axis in XYZ], "centre of mass of the robot", timeline.com_m)
    yield from _named("zmp", [f"{axis}_w_m" for axis in "xy"], "zero-moment point on the floor", timeline.zmp_m)
    for margin, point, margins in (
        ("support", "CoM's ground projection", timeline.support_margin_m),
        ("zmp", "zero-moment point", timeline.zmp_margin_m),
        ("capture", "capture point", timeline.capture_margin_m),
    ):
        about = f"least distance of the {point} from the border of the support polygon in the tick, positive inside"
        yield _column(f"{margin}_margin_m", "m", about, margins)
    about = "moment of the forces on the feet about the CoM"
    yield from _named("foot_moment", [f"{axis}_w_n_m" for axis in XYZ], about, timeline.foot_moment_n_m)
    yield _column("reward", "", "reward of the step, in its last row", _rewards(timeline))


def _rewards(timeline: Timeline) -> Floats:
    """The reward of each step in its last row, NaN in the others, (n,)."""
    rewards = np.full(timeline.n_rows, np.nan)
    for step in timeline.steps:
        if step.n_rows and step.number in timeline.rewards:
            rewards[step.first_row + step.n_rows - 1] = timeline.rewards[step.number]
    return rewards


def _kind(motion: object) -> str:
    return type(motion).__name__.lower()


def _named(prefix: str, names: Sequence[str], about: str, values: Floats) -> Iterator[Column]:
    """A column for each name, whose last word gives the unit."""
    for name, column in zip(names, values.T, strict=True):
        unit = next((symbol for ending, symbol in UNITS.items() if f"_{name}".endswith(ending)), "")
        yield _column(f"{prefix}_{name}", unit, about, column)


def _column(name: str, unit: str, about: str, values: NDArray[np.generic]) -> Column:
    return Column(name=name, unit=unit, about=about, values=values)
