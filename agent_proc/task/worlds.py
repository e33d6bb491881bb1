"""Checks that a world knows the episodes that it is asked for, before anything is written."""

from collections.abc import Callable, Iterable, Iterator
from typing import Final

import numpy as np

from agent_proc.simulators import unknown_in
from agent_proc.task.config import TaskConfig
from agent_proc.task.domain import Domain
from agent_proc.task.drawn import drawn_scenario
from legpush.errors import ConfigError, LegpushError
from legpush.options.learning import DEFAULT_WORLD
from legpush.scene.scenario import Scenario

WORLDS: Final = ("map", "map_unknown", DEFAULT_WORLD)
"""Worlds that an error can name instead."""
PLAIN_SCENARIO: Final = "open"
"""The scenario that it can name instead: without obstacles, slope and realism."""
N_DRAWS: Final = 20
"""Draws of a domain that are looked at: enough to see each of its shapes."""
Episodes = Callable[[str | None], Iterable[Scenario]]
"""Scenarios of some episodes, in the scenario of this name or, without one, in that which was asked for."""


def require_known(world: str, episodes: Episodes, flag: str = "--world", scenario_flag: str = "--scenario") -> None:
    """Require a world that knows these episodes.

    Raises:
        ConfigError: It does not, or the file of a map cannot be used; says what it knows, and what to give instead.
        PluginError: There is no such world.
    """
    fault = unknown_in(world, episodes(None))
    if fault is None:
        return
    instead = [f"{flag} {other}" for other in WORLDS if other != world and unknown_in(other, episodes(None)) is None]
    if _knows_plain(world, episodes):
        instead.append(f"{scenario_flag} {PLAIN_SCENARIO}")
    raise ConfigError(
        f"Expected a world that knows these episodes for {flag}, got {world} ({fault}); give {' or '.join(instead)}"
    )


def of_training(task: TaskConfig) -> Iterator[Scenario]:
    """Yield the scenarios of some episodes and evaluations of a training.

    Raises:
        ConfigError: The domain has no box that can be made.
    """
    if task.evaluation == "scenario":
        yield task.scenario
    yield from drawn_scenarios(task.domain, task.scenario)


def drawn_scenarios(domain: Domain, scenario: Scenario) -> Iterator[Scenario]:
    """Yield scenarios that a domain draws (`ConfigError` if it has no box that can be made)."""
    for seed in range(N_DRAWS):
        yield drawn_scenario(domain, scenario, np.random.default_rng(seed))


def _knows_plain(world: str, episodes: Episodes) -> bool:
    try:
        return unknown_in(world, episodes(PLAIN_SCENARIO)) is None
    except LegpushError:
        return False
