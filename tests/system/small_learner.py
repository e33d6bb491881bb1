"""A short training as a process: `python small_learner.py [--join RUN, and further options of simulators]`.

It says the number of each update on a line, and at last the CRC of the weights. Without --join it learns in worlds of
its own process.
"""

import sys
import threading
from contextlib import ExitStack
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final
from zlib import crc32

import torch
from stable_baselines3 import PPO
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.logger import Logger

from agent_proc.learning.vec_env import PushVecEnv
from agent_proc.policies.sb3.arguments import use_one_thread
from agent_proc.simulators import simulators
from legpush.arguments import parse
from legpush.lockstep.local import LocalWorld
from legpush.lockstep.world import SteppingWorld
from legpush.options.learning import SimulatorOptions
from sim_proc.simulator import Simulator
from tests.agent.tasks import tuned

N_WORLDS: Final = 4
N_STEPS: Final = 4
N_UPDATES: Final = 6


class Tell(BaseCallback):
    """Says how often the weights were updated, before each rollout."""

    def _on_rollout_start(self) -> None:
        print(self.num_timesteps // (N_WORLDS * N_STEPS), flush=True)

    def _on_step(self) -> bool:
        return True


def learn(worlds: list[SteppingWorld]) -> int:
    """Learn a little; returns the CRC of the weights."""
    use_one_thread()
    environments = PushVecEnv(tuned(max_steps=4), worlds, seed=5)
    model = PPO("MlpPolicy", environments, n_steps=N_STEPS, batch_size=8, n_epochs=2, seed=5, device="cpu")
    model.set_logger(Logger(None, []))
    model.learn(N_UPDATES * N_WORLDS * N_STEPS, callback=Tell())
    environments.close()
    weights = torch.cat([each.flatten() for each in model.policy.state_dict().values()])
    return crc32(weights.numpy().tobytes())


def main() -> None:
    """Learn where the command line says."""
    options = parse(SimulatorOptions, "small_learner", sys.argv[1:])
    with ExitStack() as stack:
        worlds: list[SteppingWorld] = [LocalWorld(Simulator()) for _ in range(N_WORLDS)]
        if options.join is not None:
            logs = Path(stack.enter_context(TemporaryDirectory()))
            worlds = [*stack.enter_context(simulators(options, logs, threading.Event(), kind="test"))]
        print(f"weights {learn(worlds):08x}", flush=True)


if __name__ == "__main__":
    main()
