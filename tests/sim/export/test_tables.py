"""Tables of the time series: every number as it was recorded."""

import csv
from pathlib import Path

import numpy as np
import pytest
from pyarrow import parquet

from legpush.history.timeline import Timeline
from legpush.scene.conventions import LEGS
from sim_proc.export.columns import columns_of
from sim_proc.export.source import Source
from sim_proc.export.table_csv import write_csv
from sim_proc.export.table_parquet import write_parquet

UNITS = {
    "_n_m": b"N m",
    "_m_s2": b"m/s^2",
    "_m_s": b"m/s",
    "_rad_s": b"rad/s",
    "_m": b"m",
    "_rad": b"rad",
    "_n": b"N",
    "_s": b"s",
}


@pytest.fixture
def timelines(source: Source) -> list[Timeline]:
    assert len(source.episodes) == 2
    return [episode.timeline for episode in source.episodes]


def expected(timelines: list[Timeline]) -> dict[str, np.ndarray]:
    """Some columns, put together from the timelines by hand."""
    xyz = "xyz"
    columns: dict[str, list[np.ndarray]] = {}
    for timeline in timelines:
        one = {"tick": timeline.tick, "time_s": timeline.tick * 0.02, "support_margin_m": timeline.support_margin_m}
        one["zmp_margin_m"], one["capture_margin_m"] = timeline.zmp_margin_m, timeline.capture_margin_m
        for i, axis in enumerate(xyz):
            one[f"foot_moment_{axis}_w_n_m"] = timeline.foot_moment_n_m[:, i]
            one[f"trunk_{axis}_w_m"] = timeline.qpos[:, i]
            one[f"box_{axis}_w_m"] = timeline.qpos[:, 19 + i]
            one[f"com_{axis}_w_m"] = timeline.com_m[:, i]
            for foot, leg in enumerate(LEGS):
                one[f"tip_{leg}_{axis}_w_m"] = timeline.tips_m[:, foot, i]
                one[f"force_{leg}_{axis}_w_n"] = timeline.contact_forces_n[:, foot, i]
        for i, part in enumerate("wxyz"):
            one[f"trunk_q{part}_w"] = timeline.qpos[:, 3 + i]
            one[f"box_q{part}_w"] = timeline.qpos[:, 22 + i]
        one["joint_FL_hip_x_rad"], one["joint_FR_hip_y_rad"] = timeline.qpos[:, 7], timeline.qpos[:, 11]
        one["joint_RR_knee_rad"] = timeline.qpos[:, 18]
        one["joint_FR_hip_y_rad_s"] = timeline.joint_velocities_rad_s[:, 4]
        one["joint_RR_knee_n_m"] = timeline.joint_torques_n_m[:, 11]
        for name, values in one.items():
            columns.setdefault(name, []).append(values)
    return {name: np.concatenate(parts) for name, parts in columns.items()}


def test_a_parquet_file_has_the_numbers_of_the_recording_bit_for_bit(
    source: Source, timelines: list[Timeline], tmp_path: Path
) -> None:
    write_parquet(columns_of(source.episodes), {"source": "a.mcap"}, tmp_path / "a.parquet")
    table = parquet.read_table(tmp_path / "a.parquet")
    wanted = expected(timelines)
    assert len(wanted) == 3 + 2 + 12 + 24 + 8 + 3 + 2
    for name, values in wanted.items():
        np.testing.assert_array_equal(table[name].to_numpy().astype(np.float64).view(np.int64), values.view(np.int64))
    assert set(table["episode"].to_pylist()) == {0, 1}
    motions = dict.fromkeys(zip(table["episode"].to_pylist(), table["motion"].to_pylist(), strict=True))
    assert list(motions) == [(0, "reset"), (0, "push"), (0, "walk"), (1, "reset"), (1, "push")]
    steps = dict.fromkeys(zip(table["episode"].to_pylist(), table["step"].to_pylist(), strict=True))
    assert list(steps) == [(0, 0), (0, 1), (0, 3), (1, 0), (1, 1)]


def test_a_parquet_file_says_what_its_columns_are(source: Source, tmp_path: Path) -> None:
    write_parquet(columns_of(source.episodes), {"source": "a.mcap"}, tmp_path / "a.parquet")
    schema = parquet.read_schema(tmp_path / "a.parquet")
    assert schema.metadata[b"legpush.source"] == b"a.mcap"
    for field in schema:
        unit = next((unit for ending, unit in UNITS.items() if field.name.endswith(ending)), b"")
        assert field.metadata[b"unit"] == unit, field.name
        assert field.metadata[b"about"]


def test_a_csv_file_reads_back_to_the_same_numbers(source: Source, timelines: list[Timeline], tmp_path: Path) -> None:
    write_csv(columns_of(source.episodes), tmp_path / "a.csv")
    with (tmp_path / "a.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == sum(timeline.n_rows for timeline in timelines)
    for name, values in expected(timelines).items():
        np.testing.assert_array_equal(np.array([float(row[name]) for row in rows]), values)
    assert {row["sim"] for row in rows} == {"main"}


def test_the_reward_of_a_step_is_in_the_row_of_its_end_and_nowhere_else(
    source: Source, timelines: list[Timeline]
) -> None:
    rewards = next(column.values for column in columns_of(source.episodes) if column.name == "reward")
    push = timelines[0].steps[1]
    (rows,) = np.nonzero(np.isfinite(rewards.astype(np.float64)))
    assert rows.tolist() == [push.world.tick]
    assert rewards[push.world.tick] == 0.1 + 0.2


def test_names_are_unique_and_end_in_their_units(source: Source) -> None:
    columns = columns_of(source.episodes)
    assert len({column.name for column in columns}) == len(columns)
    for column in columns:
        suffix = {"m": "_m", "rad": "_rad", "N": "_n", "s": "_s"}.get(column.unit, "")
        assert column.name.endswith(suffix)
