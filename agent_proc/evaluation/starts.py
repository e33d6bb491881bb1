"""Starts of evaluations: their seeds by what they are for, and what they draw.

What is chosen on some starts is judged on others.
"""

from collections.abc import Callable, Iterable, Mapping
from typing import Final

from msgspec.structs import replace

from agent_proc.task.config import TaskConfig
from agent_proc.task.drawn import scenario_of_start
from legpush.errors import ConfigError
from legpush.scene.scenario import Scenario

FIRST_CHECK_SEED: Final = 1_000_000
"""Starts by which a training chooses its best policy."""
FIRST_FINAL_SEED: Final = 2_000_000
"""Starts of the further evaluation of a training in a study."""
FIRST_SEARCH_SEED: Final = 4_000_000
"""Starts by which the best constant action is chosen."""


def require_held_out(seeds: Iterable[int], used: Mapping[str, Iterable[int]], flag: str) -> None:
    """Require starts on which nothing was chosen; `used` has the others, by what was chosen on them.

    Raises:
        ConfigError: A start was used before; names what for.
    """
    asked = set(seeds)
    for what, others in used.items():
        if both := sorted(asked.intersection(others)):
            raise ConfigError(
                f"Expected starts that nothing was chosen on for {flag}, got {len(both)}, such as {both[0]}, by which "
                f"{what} was chosen"
            )


def starts_of(task: TaskConfig) -> Callable[[Scenario, int], Scenario]:
    """What each start of an evaluation has in place of a scenario."""
    if task.evaluation == "scenario":
        return lambda scenario, _seed: scenario
    return lambda scenario, seed: scenario_of_start(replace(task, scenario=scenario), seed)
