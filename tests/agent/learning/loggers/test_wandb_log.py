from pathlib import Path

import numpy as np
import pytest

from agent_proc.learning.loggers.wandb_log import WandbLog
from agent_proc.learning.training_plan import TrainingPlan
from agent_proc.task.file import load_task
from tests.agent.learning.small_training import small_profile
from tests.legpush.fakes import eventually


def test_a_run_lies_in_the_folder_without_a_network_and_without_links(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("WANDB_MODE", "WANDB_PROJECT", "WANDB_DIR"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    folder = tmp_path / "training"
    folder.mkdir()
    profile = small_profile()
    plan = TrainingPlan(profile=profile, task=load_task("tuned"), seed=1, n_simulators=1, command="c", versions={})
    log = WandbLog(plan, folder)
    log.write({"rollout/success_rate": np.float64(0.5), "text": "none"}, {}, 32)
    log.close()

    (run,) = (folder / "wandb").glob("offline-run-*")
    (data,) = run.glob("*.wandb")
    # The process of W&B writes the file, and may still do so.
    assert eventually(lambda: b"rollout/success_rate" in data.read_bytes(), within_s=60.0)
    assert [path for path in folder.rglob("*") if path.is_symlink()] == []
