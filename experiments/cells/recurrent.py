"""The kind of cell that trains recurrent PPO on a task, and judges its last policy on held-out starts.

What an LSTM remembers of the pushes is another way to feel a box. legpush has no recurrent policies for missions, since
a decision there depends on nothing but what is seen; this cell says what they would be worth.
"""

from collections import deque
from collections.abc import Collection, Mapping, Sequence
from typing import Annotated, Any, Final

import numpy as np
import torch
from msgspec import Meta, Struct
from sb3_contrib import RecurrentPPO
from stable_baselines3.common.logger import Logger
from stable_baselines3.common.vec_env import VecMonitor, VecNormalize

from agent_proc.evaluation.starts import FIRST_FINAL_SEED
from agent_proc.learning.env import PushEnv
from agent_proc.learning.vec_env import PushVecEnv
from agent_proc.policies.sb3.arguments import use_one_thread
from agent_proc.studies.cell_parts import new_simulator, require_simulator
from agent_proc.task.config import TaskConfig
from agent_proc.task.drawn import scenario_of_start
from agent_proc.task.file import load_task
from legpush.fields import Seed, require_seeds
from legpush.history.steps import PlanRecord, StepRecord
from legpush.lockstep.local import LocalWorld
from legpush.options.learning import DEFAULT_WORLD
from legpush.scene.conventions import CONTROL_PERIOD_S
from legpush.study.cells import CellKind, Column

N_LSTM: Final = 64
HIDDEN: Final = (64, 64)
"""Layers of actor and critic after their LSTM; those of the profile `tuned`."""
LEARNING_RATE: Final = 1e-3
BATCH_SIZE: Final = 128
N_EPOCHS: Final = 10
GAE_LAMBDA: Final = 0.9
LOG_STD: Final = -0.7
COLUMNS: Final = (
    Column(name="final_success", unit="", about="by each start: whether the last policy was done, within tolerances"),
    Column(name="final_ended", unit="", about="by each start: how the episode ended"),
    Column(name="final_position_error_m", unit="m", about="by each start"),
    Column(name="final_angle_error_deg", unit="deg", about="by each start"),
    Column(name="final_n_cycles", unit="", about="by each start: number of pushes"),
    Column(name="final_simulated_s", unit="s", about="by each start: simulated time of the episode"),
)


class RecurrentTraining(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A training as a study file sets it."""

    task: str
    seed: Seed = 0
    """Seed of initial weights, exploration and starts."""
    world: str = DEFAULT_WORLD
    steps: Annotated[int, Meta(ge=1)] = 80_000
    n_simulators: Annotated[int, Meta(ge=1, le=64)] = 8
    n_steps: Annotated[int, Meta(ge=8)] = 64
    """Steps of each simulator between two updates."""
    final_episodes: Annotated[int, Meta(ge=1, le=10_000)] = 100
    final_first_seed: Seed = FIRST_FINAL_SEED
    final_world: str | None = None
    """Simulator of the held-out starts, in place of the one that the policy was trained in."""


class ResolvedRecurrent(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A training that needs no other file."""

    task: TaskConfig
    seed: Seed
    world: str
    steps: int
    n_simulators: int
    n_steps: int
    final_episodes: int
    final_first_seed: Seed
    final_world: str


def resolve(cell: RecurrentTraining, _: Collection[str]) -> ResolvedRecurrent:
    """Load the task.

    Raises:
        ConfigError: There is no such task or world.
    """
    final_world = cell.world if cell.final_world is None else cell.final_world
    for world in (cell.world, final_world):
        require_simulator(world)
    require_seeds(cell.final_first_seed, cell.final_episodes, "final_first_seed")
    return ResolvedRecurrent(
        task=load_task(cell.task),
        seed=cell.seed,
        world=cell.world,
        steps=cell.steps,
        n_simulators=cell.n_simulators,
        n_steps=cell.n_steps,
        final_episodes=cell.final_episodes,
        final_first_seed=cell.final_first_seed,
        final_world=final_world,
    )


def run(cell: ResolvedRecurrent) -> Mapping[str, Any]:
    """Train, then evaluate the last policy."""
    use_one_thread()
    torch.manual_seed(cell.seed)
    worlds = [LocalWorld(new_simulator(cell.world)) for _ in range(cell.n_simulators)]
    environments = PushVecEnv(cell.task, worlds, cell.seed)
    normalizer = VecNormalize(VecMonitor(environments))
    model = RecurrentPPO(
        "MlpLstmPolicy",
        normalizer,
        learning_rate=LEARNING_RATE,
        n_steps=cell.n_steps,
        batch_size=BATCH_SIZE,
        n_epochs=N_EPOCHS,
        gae_lambda=GAE_LAMBDA,
        policy_kwargs={"lstm_hidden_size": N_LSTM, "net_arch": list(HIDDEN), "log_std_init": LOG_STD},
        seed=cell.seed,
        device="cpu",
    )
    model.set_logger(Logger(None, []))
    model.learn(cell.steps)
    environments.close()
    normalizer.training = False
    last: deque[StepRecord | PlanRecord] = deque(maxlen=1)
    environment = PushEnv(cell.task, LocalWorld(new_simulator(cell.final_world), on_record=last.append))
    seeds = range(cell.final_first_seed, cell.final_first_seed + cell.final_episodes)
    ends = [{**_end(model, normalizer, environment, cell.task, seed), **_time(last)} for seed in seeds]
    environment.close()
    return {
        "final_success": [bool(end["is_success"]) for end in ends],
        "final_ended": [_ended(end["ending"]) for end in ends],
        "final_position_error_m": [round(end["position_error_m"], 6) for end in ends],
        "final_angle_error_deg": [round(end["angle_error_deg"], 5) for end in ends],
        "final_n_cycles": [end["n_cycles"] for end in ends],
        "final_simulated_s": [end["simulated_s"] for end in ends],
    }


def _end(
    model: RecurrentPPO, normalizer: VecNormalize, environment: PushEnv, task: TaskConfig, seed: int
) -> dict[str, Any]:
    """The last info of an episode without exploration, with its number of pushes."""
    options = {"scenario": scenario_of_start(task, seed), "scenario_seed": seed}
    observation, _ = environment.reset(options=options)
    state, n_cycles = None, 0
    while True:
        seen = normalizer.normalize_obs(observation)
        action, state = model.predict(seen, state, np.array([n_cycles == 0]), deterministic=True)
        observation, _, terminated, truncated, info = environment.step(action)
        n_cycles += 1
        if terminated or truncated:
            return {**info, "n_cycles": n_cycles}


def _time(last: Sequence[StepRecord | PlanRecord]) -> dict[str, float]:
    """The simulated time of the episode whose last record this is."""
    (record,) = last
    if not isinstance(record, StepRecord):
        raise TypeError(f"Expected a step, got {record}")
    return {"simulated_s": round(record.outcome.world.tick * CONTROL_PERIOD_S, 2)}


def _ended(ending: str) -> str:
    """The word of an evaluation for the ending of an episode."""
    return {"success": "done", "missed": "done", "max_steps": "max_cycles"}.get(ending, ending)


RECURRENT: Final = CellKind(
    specification=RecurrentTraining, run=run, resolved=ResolvedRecurrent, resolve=resolve, columns=COLUMNS
)
"""The kind of cell."""
