"""`python -m benchmarks.map_world.speed`: pushes per CPU second in the world without physics and in the simulator.

Both are stepped through the same environment, `legpush/Push-v1`, with the same random actions, in turn in one process;
resets count too. Many boxes at once are pushed by the map alone, without an environment. The numbers go to
`results/map_world_speed.json`.
"""

from dataclasses import dataclass
from time import process_time

import numpy as np
import tyro

from agent_proc.learning.env import PushEnv
from agent_proc.learning.make_env import make_push_env
from agent_proc.map_world.response_map import load_response_map
from agent_proc.statistics.intervals import median
from agent_proc.statistics.paired import common, paired_ratio
from benchmarks.report import write_report
from experiments.tables.parts import plain

TIMES_MORE = 50
"""The map gets this many times as many pushes as the simulator in each turn."""


@dataclass(frozen=True, kw_only=True)
class Config:
    """How much to measure."""

    n_turns: int = 8
    """Turns of the two worlds, each with actions of its own."""
    n_pushes: int = 60
    """Pushes of the simulator in each turn."""
    n_boxes: int = 1000
    """Boxes that are pushed at once without an environment."""


def main(config: Config) -> None:
    """Measure and report the numbers."""
    envs = {name: make_push_env(simulator=name) for name in ("mujoco", "map")}
    per_s: dict[str, dict[int, float]] = {"mujoco": {}, "map": {}, "boxes_at_once": {}}
    for turn in range(config.n_turns):
        per_s["mujoco"][turn] = pushes_per_s(envs["mujoco"], config.n_pushes, turn)
        per_s["map"][turn] = pushes_per_s(envs["map"], TIMES_MORE * config.n_pushes, turn)
        per_s["boxes_at_once"][turn] = boxes_per_s(config.n_boxes, turn)
    write_report(
        "map_world_speed",
        {
            "pushes_per_cpu_s": {name: plain(median(list(turns.values())), 1) for name, turns in per_s.items()},
            "map_over_simulator": {
                "geometric_mean": plain(paired_ratio(per_s["map"], per_s["mujoco"]), 1),
                "median": plain(median([a / b for a, b in common(per_s["map"], per_s["mujoco"])]), 1),
            },
        },
    )


def pushes_per_s(env: PushEnv, n_pushes: int, seed: int) -> float:
    """Return the pushes per CPU second of an environment with random actions."""
    actions = np.random.default_rng(seed).uniform(-1.0, 1.0, (n_pushes, 4)).astype(np.float32)
    began_s = process_time()
    env.reset(seed=seed)
    for action in actions:
        _, _, terminated, truncated, _ = env.step(action)
        if terminated or truncated:
            env.reset()
    return n_pushes / (process_time() - began_s)


def boxes_per_s(n_boxes: int, seed: int) -> float:
    """Return the pushes per CPU second of the map alone, many boxes at once, over a hundred pushes of each."""
    rng, response_map = np.random.default_rng(seed), load_response_map()
    poses, n_rounds = np.zeros((n_boxes, 3)), 100
    began_s = process_time()
    for _ in range(n_rounds):
        mirror = rng.choice([-1.0, 1.0], n_boxes)
        depth_m, w1, w2 = rng.uniform(0.005, 0.1, n_boxes), rng.uniform(size=n_boxes), rng.uniform(size=n_boxes)
        poses = response_map.push(poses, mirror, depth_m, w1, w2, normal=rng.standard_normal((n_boxes, 3)))
    return n_boxes * n_rounds / (process_time() - began_s)


if __name__ == "__main__":
    main(tyro.cli(Config))
