"""Reports of benchmarks say how they were made."""

import json
from pathlib import Path

import pytest

from benchmarks import report


def test_a_report_has_machine_versions_command_and_commit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(report, "RESULTS", tmp_path)
    monkeypatch.setattr("sys.orig_argv", ["/usr/bin/python3", "-m", "benchmarks.push_cycle", "--n-cycles", "3"])

    path = report.write_report("push_cycle", {"n": 3})

    found = json.loads(path.read_text())
    made = found["made"]["push_cycle"]
    assert found["n"] == 3
    assert made["command"] == "python -m benchmarks.push_cycle --n-cycles 3"
    assert made["machine"].endswith("cores")
    assert made["versions"]["mujoco"]
    assert made["commit"]


@pytest.mark.parametrize("path", sorted(report.RESULTS.glob("*.json")), ids=lambda path: path.stem)
def test_every_report_says_with_which_version_and_commit_it_was_made(path: Path) -> None:
    made = json.loads(path.read_text())["made"]

    assert made
    assert all(how["version"] and how["commit"] for how in made.values())
