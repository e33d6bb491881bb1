from pathlib import Path
from typing import Any

from agent_proc.evaluation.starts import FIRST_SEARCH_SEED
from agent_proc.rivals.blind import action_grid
from agent_proc.studies.comparison.constants import ROUNDS, best_constant
from agent_proc.task.file import load_task
from legpush.study.file import Study

WANTED = (0.6, 0.0, 1.0, -0.5)


def test_the_best_action_survives_all_rounds_and_the_starts_are_those_of_the_search(tmp_path: Path) -> None:
    task = load_task("tuned")
    sizes: list[tuple[int, int]] = []

    def run_round(study: Study, path: Path) -> list[dict[str, Any]]:
        assert path.parent == tmp_path
        tasks = list(study.tasks())
        seeds = {each.inputs["seed"] for each in tasks}
        assert min(seeds) == FIRST_SEARCH_SEED
        sizes.append((len(tasks) // len(seeds), len(seeds)))
        rows = []
        for each in tasks:
            action = tuple(each.inputs["action"])
            distance = sum(abs(a - b) for a, b in zip(action, WANTED, strict=True))
            ending = "done" if action[2] == WANTED[2] else "astray"
            rows.append({**each.inputs, "ending": ending, "position_error_m": 0.001 * distance, "angle_error_deg": 0.0})
        return rows

    settings = {"scenario": "push", "task": "tuned", "world": "map"}
    found = best_constant(task, settings, task.scenario.goal, tmp_path, run_round)
    assert found == WANTED
    assert sizes == list(zip((len(action_grid(task)), 23, 6), ROUNDS, strict=True))
