"""Sweeps: fields of the scenario that an evaluation varies, one after the other or in a grid."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import reduce
from itertools import product
from typing import Any

from legpush.errors import ConfigError
from legpush.scenarios.changes import override
from legpush.scene.scenario import Scenario

Value = float | str | tuple[float, ...]


@dataclass(frozen=True, kw_only=True)
class Sweep:
    """The scenarios of an evaluation, and how they differ."""

    fields: tuple[str, ...]
    """Fields that are swept."""
    cases: Mapping[str, Scenario]
    """By their change, such as `box.mass_kg=0.5`; an empty text if nothing is changed."""
    grid: bool
    """Whether the cases are all combinations of the values."""

    def columns(self, case: str) -> dict[str, float | str]:
        """Values of the swept fields in a case."""
        return {field: _shown(value_at(self.cases[case], field)) for field in self.fields}


def make_sweep(scenario: Scenario, texts: Iterable[str], *, grid: bool) -> Sweep:
    """Make the scenarios of all sweeps, such as `box.mass_kg=0.1,0.5` or `box.size_m=0.4x0.5x0.4,0.8x0.4x0.4`.

    Without a sweep, the only case is the scenario itself. If the robot starts at its station, the start is moved so
    that it also stands at its station if box or robot have another size.

    Raises:
        ConfigError: A sweep cannot be parsed, or a field is swept twice.
        ScenarioError: A field does not exist, or a value cannot be used.
    """
    parsed = [parse_sweep(text) for text in texts]
    names = tuple(field for field, _ in parsed)
    if twice := {name for name in names if names.count(name) > 1}:
        raise ConfigError(f"Expected each field once in --sweep, got {', '.join(sorted(twice))} twice")
    if not parsed:
        return Sweep(fields=(), cases={"": scenario}, grid=False)
    single = [[(field, value) for value in values] for field, values in parsed]
    changes = list(product(*single)) if grid else [((field, value),) for row in single for field, value in row]
    cases = {_name(change): override(scenario, dict(change), f"--sweep {_name(change)}") for change in changes}
    return Sweep(fields=names, cases=cases, grid=grid)


def parse_sweep(text: str) -> tuple[str, tuple[Value, ...]]:
    """Split a sweep into its field and values.

    Raises:
        ConfigError: It is not of the form FIELD=VALUE,VALUE,...
    """
    field, equals, values = text.partition("=")
    parts = [part.strip() for part in values.split(",")]
    if not (field and equals and all(parts)):
        raise ConfigError(f"Expected FIELD=VALUE,VALUE,... for --sweep, such as box.mass_kg=0.1,0.5, got {text!r}")
    return field.strip(), tuple(_value(part) for part in parts)


def _name(change: Iterable[tuple[str, Value]]) -> str:
    return " ".join(f"{field}={_shown(value)}" for field, value in change)


def value_at(record: Any, path: str) -> Any:
    """The value of a field, by its path such as `box.mass_kg`."""
    return reduce(getattr, path.split("."), record)


def _shown(value: Value) -> float | str:
    return "x".join(f"{part:g}" for part in value) if isinstance(value, tuple) else value


def _value(text: str) -> Value:
    """Parse a number, several numbers joined by `x`, or a word."""
    try:
        numbers = tuple(float(part) for part in text.split("x"))
    except ValueError:
        return text
    return numbers[0] if len(numbers) == 1 else numbers
