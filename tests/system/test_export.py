"""A mission, recorded and exported: the files say what its report says."""

import json
import subprocess
import sys
from math import degrees
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pyarrow import parquet

from tests.sim.export.foxglove_reading import read
from tests.sim.export.program import export

CLI = [sys.executable, "-P", "-c", "import sys; from legpush.cli import main; sys.exit(main())"]


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict[str, Any]]:
    """The recording of a mission, and its report."""
    folder = tmp_path_factory.mktemp("mission")
    words = [
        "run",
        "--scenario",
        "push",
        "--no-video",
        "--record",
        str(folder / "a.mcap"),
        "--out",
        str(folder / "run"),
    ]
    done = subprocess.run([*CLI, *words], capture_output=True, text=True, check=False, timeout=120)
    assert done.returncode == 0, done.stderr
    return folder / "a.mcap", json.loads((folder / "run" / "report.json").read_text())


def test_the_table_of_a_mission_ends_with_the_errors_of_its_report(
    recorded: tuple[Path, dict[str, Any]], tmp_path: Path
) -> None:
    recording, report = recorded
    done = export(recording, "--out", tmp_path / "a.parquet")
    assert (done.returncode, done.stderr) == (0, "")
    table = parquet.read_table(tmp_path / "a.parquet")
    columns = {name: table[name].to_numpy() for name in ("time_s", "box_error_m", "box_error_rad", "reward", "tick")}
    assert columns["box_error_m"][-1] == pytest.approx(report["box_position_error_m"], abs=1e-12)
    assert degrees(columns["box_error_rad"][-1]) == pytest.approx(report["box_angle_error_deg"], abs=1e-9)
    assert columns["time_s"][-1] == pytest.approx(report["sim_time_s"])
    assert np.isfinite(columns["reward"]).sum() == report["n_push_cycles"]
    np.testing.assert_array_equal(columns["tick"], np.arange(len(table)))


def test_the_foxglove_file_of_a_mission_has_its_plans_pushes_and_phases(
    recorded: tuple[Path, dict[str, Any]], tmp_path: Path
) -> None:
    recording, report = recorded
    assert export(recording, "--out", tmp_path / "a.mcap").returncode == 0
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
