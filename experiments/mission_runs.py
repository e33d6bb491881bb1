"""One mission as a user runs it: `legpush run` in three processes, its report and what was recorded."""

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
    """Run it; where it fails, its picture goes to the folder `failed`. `SystemExit` where there is no result."""
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
