"""`python -m benchmarks.map_world.transfer`: policies learned without physics, in the simulator.

For each training seed, the profile `tuned` learns in the simulator; in the map; and in the map, then for a few more
steps in the simulator. All three are evaluated in the simulator from the same unseen starts. The last policy counts, so
nothing is chosen after the fact. The numbers go to `results/map_world_transfer.json`.
"""

import threading
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass
from multiprocessing import get_context
from pathlib import Path
from time import process_time
from typing import Any, Final

import tyro
from msgspec.structs import replace

from agent_proc.evaluation.episodes import run_episode
from agent_proc.learning.training import LAST, Training
from agent_proc.learning.training_plan import TrainingPlan
from agent_proc.learning.vec_env import PushVecEnv
from agent_proc.policies.folder import read_policy
from agent_proc.policies.learned import LearnedPolicy
from agent_proc.profiles.profile import PpoProfile, load_profile
from agent_proc.statistics.intervals import mean_of_groups
from agent_proc.studies.cell_parts import new_simulator
from agent_proc.task.file import load_task
from benchmarks.report import write_report
from experiments.tables.parts import plain
from legpush.lockstep.local import LocalWorld
from legpush.runs.temporary import temporary_folder
from legpush.scenarios.file import load_scenario

REAL: Final = "mujoco"
FIRST_SEED: Final = 7_310_000
N_WORLDS: Final = 2
TUNING_LOG_STD: Final = -1.5
"""Exploration at the first of the further steps: a policy that can push already needs less than a new one."""
TUNING_RATE: Final = 3e-4
"""Learning rate of the further steps, less than a third of that of `tuned`."""


@dataclass(frozen=True, kw_only=True)
class Config:
    """How much to measure."""

    n_trainings: int = 5
    """Training seeds, from 1."""
    n_starts: int = 20
    """Starts from which every policy is evaluated."""
    tuning_steps: int = 1024
    """Push cycles in the simulator after a training in the map."""
    steps: int | None = None
    """Replaces the number of push cycles of the profile."""
    workers: int = 2
    """Processes."""


@dataclass(frozen=True, kw_only=True)
class Learned:
    """A training and its last policy in the simulator."""

    variant: str
    seed: int
    cpu_s: float
    """Of the training, with those before it."""
    position_error_m: tuple[float, ...]
    """By start, like the next two."""
    angle_error_deg: tuple[float, ...]
    success: tuple[bool, ...]


def main(config: Config) -> None:
    """Train, evaluate and report."""
    seeds = range(1, config.n_trainings + 1)
    with ProcessPoolExecutor(config.workers, mp_context=get_context("spawn")) as pool:
        found = [learned for one in pool.map(trained_three_ways, [config] * len(seeds), seeds) for learned in one]
    write_report("map_world_transfer", report_of(config, found))


def trained_three_ways(config: Config, seed: int) -> list[Learned]:
    """Train with one seed in the simulator, in the map, and in the map and then in the simulator."""
    profile = load_profile("tuned")
    if not isinstance(profile, PpoProfile):
        raise TypeError(f"Expected the profile `tuned` to train with PPO, got {profile.algorithm}")
    if config.steps is not None:
        profile = replace(profile, steps=config.steps)
    settings = replace(profile.settings, log_std_init=TUNING_LOG_STD, learning_rate=TUNING_RATE)
    tuning = replace(profile, steps=config.tuning_steps, settings=settings)
    with temporary_folder("transfer-") as folder:
        parts = {name: folder / name for name in ("simulator", "map", "tuned")}
        for part in parts.values():
            part.mkdir()
        seconds = {
            "simulator": train(profile, REAL, seed, parts["simulator"]),
            "map": train(profile, "map", seed, parts["map"]),
        }
        seconds["tuned"] = seconds["map"] + train(tuning, REAL, seed, parts["tuned"], init=parts["map"])
        return [evaluated(config, name, seed, seconds[name], part / LAST) for name, part in parts.items()]


def train(profile: PpoProfile, world: str, seed: int, folder: Path, *, init: Path | None = None) -> float:
    """Train to the end; return the CPU seconds."""
    task = load_task(profile.task, domain={"distance_m": (0.1, 1.0)})
    plan = TrainingPlan(
        profile=replace(profile, evaluate_every=profile.steps, evaluation_episodes=1),
        task=task,
        seed=seed,
        n_simulators=N_WORLDS,
        command="python -m benchmarks.map_world.transfer",
        versions={},
        world=world,
        init=None if init is None else str(init),
    )
    worlds = [LocalWorld(new_simulator(world)) for _ in range(N_WORLDS)]
    began_s, stop = process_time(), threading.Event()
    env = PushVecEnv(task, worlds, stop=stop)
    try:
        Training(plan, folder, env, worlds, stop=stop).run()
    finally:
        env.close()
    return process_time() - began_s


def evaluated(config: Config, variant: str, seed: int, cpu_s: float, folder: Path) -> Learned:
    """Run a policy in the simulator from every start."""
    policy, world = LearnedPolicy(read_policy(folder), variant), LocalWorld(new_simulator(REAL))
    starts = range(FIRST_SEED, FIRST_SEED + config.n_starts)
    rows = [run_episode(world, load_scenario("push"), start, policy) for start in starts]
    return Learned(
        variant=variant,
        seed=seed,
        cpu_s=cpu_s,
        position_error_m=tuple(row.position_error_m for row in rows),
        angle_error_deg=tuple(row.angle_error_deg for row in rows),
        success=tuple(row.success for row in rows),
    )


def report_of(config: Config, found: Sequence[Learned]) -> dict[str, Any]:
    """Return means over trainings with their intervals."""
    variants: dict[str, Any] = {}
    for name in dict.fromkeys(learned.variant for learned in found):
        mine = [learned for learned in found if learned.variant == name]
        variants[name] = {
            "position_error_m": plain(mean_of_groups([learned.position_error_m for learned in mine]), 5),
            "angle_error_deg": plain(mean_of_groups([learned.angle_error_deg for learned in mine]), 4),
            "success_rate": plain(mean_of_groups([learned.success for learned in mine]), 4),
            "cpu_s": plain(mean_of_groups([[learned.cpu_s] for learned in mine]), 1),
        }
    return {
        **asdict(config),
        "steps": config.steps or load_profile("tuned").steps,
        "variants": variants,
        "trainings": [
            {
                **asdict(learned),
                "cpu_s": round(learned.cpu_s, 1),
                "position_error_m": [round(value, 5) for value in learned.position_error_m],
                "angle_error_deg": [round(value, 4) for value in learned.angle_error_deg],
            }
            for learned in found
        ],
    }


if __name__ == "__main__":
    main(tyro.cli(Config))
