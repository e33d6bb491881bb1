"""A mission, recorded and exported: the files say what its report says."""

from math import degrees
from pathlib import Path

import numpy as np
import pytest
from pyarrow import parquet

from tests.sim.export.foxglove_reading import read
from tests.sim.export.program import export
from tests.system.conftest import RecordedMission
from tests.system.missions import report_of


def test_the_table_of_a_mission_ends_with_the_errors_of_its_report(
    push_mission: RecordedMission, tmp_path: Path
) -> None:
    report = report_of(push_mission.out)
    done = export(push_mission.file, "--out", tmp_path / "a.parquet")
    assert (done.returncode, done.stderr) == (0, "")
    table = parquet.read_table(tmp_path / "a.parquet")
    columns = {name: table[name].to_numpy() for name in ("time_s", "box_error_m", "box_error_rad", "reward", "tick")}
    assert columns["box_error_m"][-1] == pytest.approx(report["box_position_error_m"], abs=1e-12)
    assert degrees(columns["box_error_rad"][-1]) == pytest.approx(report["box_angle_error_deg"], abs=1e-9)
    assert columns["time_s"][-1] == pytest.approx(report["sim_time_s"])
    assert np.isfinite(columns["reward"]).sum() == report["n_push_cycles"]
    np.testing.assert_array_equal(columns["tick"], np.arange(len(table)))


def test_the_foxglove_file_of_a_mission_has_its_plans_pushes_and_phases(
    push_mission: RecordedMission, tmp_path: Path
) -> None:
    report = report_of(push_mission.out)
    assert export(push_mission.file, "--out", tmp_path / "a.mcap").returncode == 0
    messages = read(tmp_path / "a.mcap")
    pushes = [m.content for m in messages if m.topic == "/steps" and m.content["motion"] == "push"]
    assert len(pushes) == report["n_push_cycles"]
    assert all("reward" in push for push in pushes)
    plans = [m.content for m in messages if m.topic == "/plan/box_path"]
    assert plans
    assert len(plans[0].poses) > 10
    assert {m.content.name for m in messages if m.topic == "/log"} >= {"agent/main", "sim/main"}
    assert any(m.content.message.startswith("pushing") for m in messages if m.topic == "/log")
    times = [m.time_ns for m in messages]
    assert max(times) - min(times) == round(report["sim_time_s"] * 1e9)
