"""Tables of the reproduction, and its numbers for the pages."""

from collections.abc import Mapping
from typing import Any, Final

from experiments.rows import Row, Rows, read_rows
from experiments.tables.parts import as_csv, as_json, made_of
from experiments.tables.reproduction.factorial import FACTORS, by_level, causes, combination, parts, rungs
from experiments.tables.reproduction.summaries import (
    grouped,
    rule_columns,
    rule_numbers,
    training_columns,
    training_numbers,
)

MAP: Final = "reproduction_map"
LADDER: Final = "reproduction_ladder"
TRAININGS: Final = {
    "learns_fixed": "reproduction_learns_fixed",
    "learns_variable": "reproduction_learns_variable",
    "learns_variable_simulator": "reproduction_learns_variable_simulator",
    "observation": "reproduction_observation",
    "observation_simulator": "reproduction_observation_simulator",
    "release": "reproduction_release",
    "text": "reproduction_text",
    "tuned_fixed": "reproduction_tuned_fixed",
    "tuned_variable": "reproduction_tuned_variable",
}
"""Study of each variant that has one of its own."""
RULES: Final = ("reproduction_rules", "reproduction_rules_one", "reproduction_rules_mirrored")
"""Studies of pushing without learning."""


def read_studies() -> dict[str, Rows]:
    """Read all studies by their names."""
    return {name: read_rows(name) for name in (MAP, LADDER, *TRAININGS.values(), *RULES)}


def texts() -> dict[str, str]:
    """Return the tables by the names of their files."""
    studies = read_studies()
    factorial = studies[MAP].rows
    ladder = rungs(studies[LADDER].rows, factorial)
    trained = {variant: studies[name].rows for variant, name in TRAININGS.items()}
    blind = rule_rows(studies)
    return {
        "reproduction_map.csv": as_csv(
            [
                dict(zip(FACTORS, levels, strict=True)) | training_columns(rows)
                for levels, rows in grouped(factorial, combination).items()
            ]
        ),
        "reproduction_ladder.csv": as_csv([{"change": change, **training_columns(rows)} for change, rows in ladder]),
        "reproduction_simulator.csv": as_csv(_simulator_rows(trained, blind)),
        "reproduction_map.json": as_json(
            made_of(**{MAP: studies[MAP]}),
            {"map": by_level(factorial), "parts": parts(factorial), "causes": causes(factorial)},
        ),
        "reproduction_ladder.json": as_json(
            made_of(**{name: studies[name] for name in (LADDER, MAP)}),
            {"ladder": [{"change": change, **training_numbers(rows)} for change, rows in ladder]},
        ),
        "reproduction_simulator.json": as_json(
            made_of(**{name: studies[name] for name in (*TRAININGS.values(), *RULES)}),
            {
                "simulator": {variant: training_numbers(rows) for variant, rows in trained.items()},
                "rules": _nested({levels: rule_numbers(rows) for levels, rows in blind.items()}),
            },
        ),
    }


def rule_rows(studies: Mapping[str, Rows]) -> dict[tuple[Any, ...], list[Row]]:
    """Return the episodes without learning by rule, end and starts."""
    rows = [row for name in RULES for row in studies[name].rows]
    return grouped(rows, lambda row: (row["rule"], row["ending"], row["starts"]))


def _simulator_rows(trained: Mapping[str, list[Row]], blind: Mapping[tuple[Any, ...], list[Row]]) -> list[Row]:
    """Return trainings and rules in one table."""
    rows: list[Row] = []
    for variant, trainings in trained.items():
        rows.append({"policy": variant, "ending": "paper-learns", "starts": "scenario", **training_columns(trainings)})
    for (rule, ending, starts), episodes in blind.items():
        rows.append({"policy": rule, "ending": ending, "starts": starts, **rule_columns(episodes)})
    return rows


def _nested(values: Mapping[tuple[str, ...], Any]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for (*path, last), value in values.items():
        place = found
        for name in path:
            place = place.setdefault(name, {})
        place[last] = value
    return found
