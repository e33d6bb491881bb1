"""`legpush run` with a planner of somebody else's."""

import subprocess
import sys
from pathlib import Path

from agent_proc.reporting.mission_record import read_record
from legpush.history.steps import read_episode

LEGPUSH = str(Path(sys.executable).with_name("legpush"))
EXAMPLE = Path(__file__).parents[2] / "examples" / "grid_planner.py"


def test_the_example_planner_plans_a_mission(tmp_path: Path) -> None:
    options = ["push", "--policy", "scripted", "--no-video", "--inject-faults", "0.05"]
    command = [LEGPUSH, "run", *options, "--planner-command", f"{sys.executable} {EXAMPLE}", "--out", "mission"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False, timeout=240)

    assert done.returncode == 0, done.stderr
    record = read_record(read_episode(next((tmp_path / "mission").glob("episode-*.journal"))))
    assert record.plans
    assert all(each.plan.tree is None for each in record.plans), "the built-in planner shows its tree"
