"""Searches the best constant action of a grid, on starts that no comparison uses, with fewer candidates each round."""

from collections.abc import Callable, Mapping, Sequence
from math import ceil
from pathlib import Path
from typing import Any, Final

import numpy as np
import tomli_w

from agent_proc.evaluation.loss import episode_loss
from agent_proc.evaluation.starts import FIRST_SEARCH_SEED
from agent_proc.rivals.blind import Action, action_grid
from agent_proc.task.config import TaskConfig
from legpush.scene.scenario import Goal
from legpush.study.file import Study, read_study

ROUNDS: Final = (2, 6, 18)
"""Starts of each round (our choice); a quarter of the candidates goes on to the next one."""
KEPT: Final = 0.25
RunRound = Callable[[Study, Path], list[dict[str, Any]]]
"""Carries out the study of a round in a folder."""


def best_constant(
    task: TaskConfig, settings: Mapping[str, Any], goal: Goal, folder: Path, run_round: RunRound
) -> Action:
    """The action of the grid with the least mean loss on the starts of the last round.

    Args:
        task: Whose actions and stop rule it has.
        settings: Of every cell: scenario, world and task.
        goal: With the tolerances of the loss.
        folder: For the studies of the rounds.
        run_round: Carries out a study.
    """
    candidates = action_grid(task)
    for number, n_starts in enumerate(ROUNDS, start=1):
        rows = run_round(_study(candidates, settings, n_starts, number), folder / f"round-{number}")
        losses = _mean_losses(rows, candidates, goal)
        n_kept = 1 if n_starts == ROUNDS[-1] else ceil(KEPT * len(candidates))
        order = sorted(range(len(candidates)), key=lambda index: losses[index])
        candidates = [candidates[index] for index in order[:n_kept]]
    return candidates[0]


def _study(candidates: Sequence[Action], settings: Mapping[str, Any], n_starts: int, number: int) -> Study:
    axes = {
        "action": [[float(value) for value in action] for action in candidates],
        "seed": {"first": FIRST_SEARCH_SEED, "n": n_starts},
    }
    file = {"name": f"constants-{number}", "cell": "push", "settings": {**settings, "policy": "constant"}, "axes": axes}
    return read_study(tomli_w.dumps(file), f"the search of the best constant, round {number}")


def _mean_losses(rows: Sequence[Mapping[str, Any]], candidates: Sequence[Action], goal: Goal) -> list[float]:
    found: dict[Action, list[float]] = {tuple(map(float, action)): [] for action in candidates}
    for row in rows:
        loss = episode_loss(row["ending"] == "done", row["position_error_m"], row["angle_error_deg"], goal)
        found[tuple(row["action"])].append(loss)
    return [float(np.mean(losses)) for losses in found.values()]
