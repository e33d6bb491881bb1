"""Tables of a study: means and shares by the axes, or paired differences, with 95 % intervals."""

import csv
import io
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from math import isfinite
from typing import Any, Final

from agent_proc.statistics.estimate import Estimate
from agent_proc.statistics.intervals import mean, share
from agent_proc.statistics.paired import paired_difference
from legpush.errors import ConfigError
from legpush.study.folder import StudyFolder, StudyRecord
from legpush.study.rows import CELL, DIFFERING

SEED: Final = "seed"
"""The axis over which tables take means, if they are not told otherwise."""
NO_RESULTS: Final = frozenset({CELL, "code", *DIFFERING})
"""Columns that are neither inputs nor results."""
PAIRED: Final = "paired"
Row = Mapping[str, Any]


@dataclass(frozen=True, kw_only=True)
class StudyRows:
    """The rows of a study."""

    record: StudyRecord
    inputs: tuple[str, ...]
    """Columns of inputs."""
    rows: Sequence[Row]


@dataclass(frozen=True, kw_only=True)
class Line:
    """One number of the table."""

    measure: str
    unit: str
    group: Mapping[str, Any]
    """Values of the columns that make the groups."""
    estimate: Estimate
    """Its `n` is the number of cells, or of pairs."""
    how: str
    """What the number is, and how its interval is made, such as `share, Wilson 95 %`."""

    @property
    def title(self) -> str:
        """The measure, with its unit if its name does not end with it."""
        return (
            f"{self.measure} [{self.unit}]"
            if self.unit and not self.measure.endswith(f"_{self.unit}")
            else self.measure
        )


@dataclass(frozen=True, kw_only=True)
class Pairing:
    """Differences from the cells in which `axis` has `value`."""

    axis: str
    value: Any


def read_study_rows(folder: StudyFolder) -> StudyRows:
    """Read all rows of a study.

    Raises:
        ConfigError: It is not the folder of a study, or has no rows.
        RowsError: Rows cannot be read or differ.
    """
    record = folder.record()
    table = folder.rows()
    if table is None or not table.num_rows:
        raise ConfigError(f"{folder.path}: expected a study with rows, got none")
    return StudyRows(record=record, inputs=record.inputs, rows=table.to_pylist())


def groups_of(study: StudyRows, by: Sequence[str], pairing: Pairing | None = None) -> tuple[str, ...]:
    """Return the columns that make the groups: those that were asked for, or every axis but the seed.

    Raises:
        ConfigError: There is no such column.
    """
    for name in by:
        _require_column(study, name, "--by", study.inputs)
    chosen = tuple(by) or tuple(axis for axis in study.record.axes if axis != SEED)
    if pairing is None or pairing.axis in by:
        return chosen
    return (*(name for name in chosen if name != pairing.axis), pairing.axis)


def measures_of(study: StudyRows, asked: Sequence[str]) -> tuple[str, ...]:
    """Return the columns to summarize: those that were asked for, or every result that is a number or a truth value.

    Raises:
        ConfigError: There is no such column, or it has no numbers.
    """
    names = [name for name in study.rows[0] if name not in NO_RESULTS and name not in study.inputs]
    valid = [name for name in names if any(_is_number(row[name]) for row in study.rows)]
    for name in asked:
        _require_column(study, name, "--measure", [*valid, "cpu_s", "wall_s"])
    return tuple(asked or valid)


def pairing_of(study: StudyRows, text: str) -> Pairing:
    """Read `AXIS=VALUE`.

    Raises:
        ConfigError: There is no such axis, or it never has this value.
    """
    axis, _, word = text.partition("=")
    _require_column(study, axis, "--paired", study.record.axes)
    values = _values(study.rows, axis)
    for value in values:
        if str(value) == word or (isinstance(value, int | float) and _as_number(word) == value):
            return Pairing(axis=axis, value=value)
    raise ConfigError(f"Expected a value of {axis} among {', '.join(map(str, values))} for --paired, got {word}")


def make_table(
    study: StudyRows, by: Sequence[str], measures: Sequence[str], pairing: Pairing | None = None
) -> list[Line]:
    """Summarize every measure in every group, in the order of the study."""
    lines = []
    for measure in measures:
        unit = study.record.units.get(measure, "")
        for group, rows in _grouped(study.rows, by):
            if pairing is None:
                estimated = _estimated([row[measure] for row in rows])
            elif group[pairing.axis] == pairing.value:
                continue
            else:
                estimated = _paired(study, rows, measure, pairing)
            if estimated is not None:
                estimate, what = estimated
                how = f"{what}, {estimate.kind}"
                lines.append(Line(measure=measure, unit=unit, group=group, estimate=estimate, how=how))
    return lines


def as_csv(lines: Sequence[Line], by: Sequence[str]) -> str:
    """Return the table as CSV."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["measure", "unit", *by, "n", "value", "low", "high", "how"])
    for line in lines:
        estimate = line.estimate
        values = (line.group[name] for name in by)
        writer.writerow(
            [line.measure, line.unit, *values, estimate.n, estimate.value, estimate.low, estimate.high, line.how]
        )
    return text.getvalue()


def _paired(study: StudyRows, rows: Iterable[Row], measure: str, pairing: Pairing) -> tuple[Estimate, str] | None:
    """Return the mean difference between cells and those with the value of the pairing, all other axes being equal."""
    others = [axis for axis in study.record.axes if axis != pairing.axis]
    base = (row for row in study.rows if row[pairing.axis] == pairing.value)
    here, there = (
        {_key(row, others): float(row[measure]) for row in some if _is_number(row[measure])} for some in (rows, base)
    )
    estimate = paired_difference(here, there)
    return (estimate, PAIRED) if estimate.n else None


def _estimated(values: Sequence[Any]) -> tuple[Estimate, str] | None:
    """Return the share of true values, or the mean of numbers; cells without a finite value do not count."""
    found = [value for value in values if _is_number(value)]
    if not found:
        return None
    if all(isinstance(value, bool) for value in found):
        return share(sum(found), len(found)), "share"
    return mean([float(value) for value in found]), "mean"


def _grouped(rows: Sequence[Row], by: Sequence[str]) -> list[tuple[Mapping[str, Any], list[Row]]]:
    found: dict[str, tuple[Mapping[str, Any], list[Row]]] = {}
    for row in rows:
        found.setdefault(_key(row, by), ({name: row[name] for name in by}, []))[1].append(row)
    return list(found.values())


def _values(rows: Sequence[Row], name: str) -> list[Any]:
    return list({repr(row[name]): row[name] for row in rows}.values())


def _key(row: Row, names: Sequence[str]) -> str:
    return repr([row[name] for name in names])


def _is_number(value: Any) -> bool:
    return isinstance(value, bool | int | float) and isfinite(value)


def _as_number(word: str) -> float | None:
    try:
        return float(word)
    except ValueError:
        return None


def _require_column(study: StudyRows, name: str, flag: str, valid: Sequence[str]) -> None:
    if name not in valid:
        nearest = get_close_matches(name, valid, n=1)
        hint = f" (did you mean `{nearest[0]}`?)" if nearest else ""
        raise ConfigError(f"Expected a column among {', '.join(valid)} for {flag}, got {name}{hint}")
