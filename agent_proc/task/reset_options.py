"""The options of `reset`, which replace what an environment draws for one episode."""

from collections.abc import Mapping
from dataclasses import dataclass
from numbers import Integral
from typing import Any, Final

from legpush.errors import ConfigError
from legpush.fields import SEEDS
from legpush.scenarios.file import load_scenario
from legpush.scene.scenario import Scenario

OPTIONS: Final = ("scenario", "scenario_seed")
"""Names of the options."""


@dataclass(frozen=True, kw_only=True)
class ResetOptions:
    """What is not drawn; None where it is."""

    scenario: Scenario | None = None
    scenario_seed: int | None = None


def read_options(given: object) -> ResetOptions:
    """Read the options of a `reset`: None, or a mapping of their names.

    `scenario` is a `legpush.Scenario`, the name of a built-in scenario, or the path of a scenario file.

    Raises:
        ConfigError: There is another option, or a value cannot be used; names it.
        ScenarioError: The scenario of that name cannot be used.
    """
    if given is None:
        return ResetOptions()
    if not isinstance(given, Mapping):
        raise ConfigError(f"Expected a mapping for the options of reset, got {given!r}; {_valid()}")
    if unknown := [name for name in given if name not in OPTIONS]:
        raise ConfigError(f"Expected other options of reset, got {', '.join(map(repr, unknown))}; {_valid()}")
    return ResetOptions(
        scenario=_scenario(given["scenario"]) if "scenario" in given else None,
        scenario_seed=_seed(given["scenario_seed"]) if "scenario_seed" in given else None,
    )


def _valid() -> str:
    return f"valid are {' and '.join(f'`{name}`' for name in OPTIONS)}"


def _scenario(value: Any) -> Scenario:
    if isinstance(value, str):
        return load_scenario(value)
    if not isinstance(value, Scenario):
        raise ConfigError(
            "Expected a legpush.Scenario, or the name or path of one, for the option `scenario` of reset, "
            f"got {value!r}"
        )
    return value


def _seed(value: Any) -> int:
    if isinstance(value, bool) or not isinstance(value, Integral) or not 0 <= int(value) < SEEDS:
        raise ConfigError(
            f"Expected a whole number from 0 to {SEEDS - 1} for the option `scenario_seed` of reset, got {value!r}"
        )
    return int(value)
