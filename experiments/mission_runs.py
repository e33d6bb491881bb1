"""Runs one mission as a user does, with `legpush run` in three processes."""

import json
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from agent_proc.reporting.mission_record import MissionRecord, read_record
from legpush.history.steps import read_episode
from legpush.runs.folder import PICTURE_FILE
from legpush.scenarios.file import write_scenario
from legpush.scene.scenario import Scenario


def run_scenario(scenario: Scenario, seed: int, failed: Path | None = None) -> tuple[dict[str, Any], MissionRecord]:
    """Run a mission and return its report and its record; if it fails, copy its picture to the folder `failed`.

    Raises:
        SystemExit: The mission has no result.
    """
    with tempfile.TemporaryDirectory(prefix="legpush-mission-") as scratch:
        file, out = Path(scratch) / "scenario.toml", Path(scratch) / "run"
        write_scenario(scenario, file)
        command = [str(Path(sys.executable).with_name("legpush")), "run", "--scenario", str(file)]
        command += ["--seed", str(seed), "--out", str(out), "--no-video"]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode not in (0, 1):
            raise SystemExit(f"{scenario.name}, seed {seed}: legpush run exited with {done.returncode}: {done.stderr}")
        report = json.loads((out / "report.json").read_text())
        if failed is not None and not report["success"]:
            failed.mkdir(exist_ok=True)
            shutil.copy(out / PICTURE_FILE, failed / f"{seed}.png")
        return report, read_record(read_episode(next(out.glob("episode-*.journal"))))
