"""Missions and evaluations with a trained policy load none of the libraries with which it was trained."""

import subprocess
import sys
from pathlib import Path

import pytest

LEARNING = ("torch", "stable_baselines3", "gymnasium", "tensorboard", "onnx")
NEEDED = ("agent_proc.policies.learned", "safetensors")

MISSION = """
import legpush
import agent_proc.mission.process, legpush.launch.replay, legpush.recording.verify
assert legpush.run("push", seed=0, policy="variable").report.n_push_cycles > 5
"""
EVALUATION = """
import sys
from agent_proc.programs.evaluate import main
sys.argv[1:] = ["fixed", "--episodes", "1", "--simulators", "1", "--out", "evaluation"]
assert main() == 0
"""
LOADED = f"""
import sys
print([name for name in {LEARNING} if name in sys.modules])
print([name for name in {NEEDED} if name in sys.modules])
"""


@pytest.mark.parametrize("work", [MISSION, EVALUATION], ids=["mission", "evaluation"])
def test_a_fresh_interpreter_loads_no_learning_library(work: str, tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-c", work + LOADED], cwd=tmp_path, capture_output=True, text=True, check=False
    )

    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[-2:] == ["[]", str(list(NEEDED))]
