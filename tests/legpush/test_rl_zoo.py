"""rl-zoo3 trains in the environment by its own command line."""

import os
import subprocess
import sys
from pathlib import Path

HYPERPARAMETERS = """
legpush/Push-v1:
  n_timesteps: 64
  policy: MlpPolicy
  n_steps: 32
  batch_size: 32
"""


def test_rl_zoo_trains_by_the_id_alone(tmp_path: Path) -> None:
    (tmp_path / "ppo.yml").write_text(HYPERPARAMETERS)
    words = "--algo ppo --env legpush/Push-v1 --gym-packages legpush.gym -conf ppo.yml -f logs --eval-freq -1 --seed 1"
    command = [sys.executable, "-m", "rl_zoo3.train", *words.split(), "--env-kwargs", "simulator:'map'"]
    done = subprocess.run(command, cwd=tmp_path, env=os.environ, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[-2000:]
    assert (tmp_path / "logs" / "ppo" / "legpush-Push-v1_1" / "legpush-Push-v1.zip").is_file()
