"""What the tables and pictures of several studies share."""

import csv
import io
import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any, Final

import msgspec
import numpy as np

from agent_proc.figures import Axes, plain_log_ticks
from agent_proc.statistics.estimate import Estimate, kinds_in_words
from agent_proc.statistics.intervals import mean, share
from experiments.rows import Made, Row, Rows
from legpush.arrays import Floats

PUBLISHED: Final = Path(__file__).parents[1] / "published"


def as_csv(rows: Sequence[Mapping[str, Any]]) -> str:
    """Return rows as CSV, with the keys of the first row as columns."""
    text = io.StringIO()
    writer = csv.DictWriter(text, list(rows[0]), lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue()


def as_json(made: Mapping[str, Made], numbers: Mapping[str, Any]) -> str:
    """Return numbers as JSON, with how the rows behind them were made; a number that is not finite becomes null."""
    how = {name: _made(one) for name, one in made.items()}
    return json.dumps(msgspec.json.decode(msgspec.json.encode({"made": how, **numbers})), indent=1) + "\n"


def _made(made: Made) -> dict[str, Any]:
    return {key: value for key, value in msgspec.structs.asdict(made).items() if value}


def made_of(**rows: Rows) -> dict[str, Made]:
    """Return how the rows of studies were made, by the names of the studies."""
    return {name: one.made for name, one in rows.items()}


def published(name: str) -> list[dict[str, float]]:
    """Return a table of published numbers."""
    with (PUBLISHED / name).open(newline="") as file:
        return [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]


def plain(estimate: Estimate, n_digits: int) -> dict[str, Any]:
    """Return a rounded estimate for JSON."""
    return asdict(estimate.rounded(n_digits))


def summary_columns(episodes: Sequence[Row]) -> Row:
    """Summarize episodes of one case: means with 95 % intervals and their kinds, counts and extremes."""
    n = len(episodes)
    return {
        "n": n,
        **mean([row["position_error_m"] for row in episodes]).cut(0.0).columns("position_error_m", 7),
        **mean([row["angle_error_deg"] for row in episodes]).cut(0.0).columns("angle_error_deg", 5),
        **share(sum(row["success"] for row in episodes), n).columns("success_rate", 4),
        "successes": sum(row["success"] for row in episodes),
        "falls": sum(row["ending"] == "fell" for row in episodes),
        "cycles": round(sum(row["n_cycles"] for row in episodes) / n, 2),
        "max_abs_roll_deg": round(max(row["max_abs_roll_deg"] for row in episodes), 2),
        "max_abs_pitch_deg": round(max(row["max_abs_pitch_deg"] for row in episodes), 2),
        "min_support_margin_m": round(min(row["min_support_margin_m"] for row in episodes), 4),
    }


def errors_of(rows: Sequence[Row], key: str, scale: float = 1.0) -> tuple[Floats, Floats]:
    """Return the estimates of a measure, (n,), and how far their intervals reach below and above them, (2, n), as
    `errorbar` takes them; nan, which is not drawn, without an interval."""
    middle, low, high = (
        scale * np.array([row[name] for row in rows], dtype=np.float64) for name in (key, f"{key}_low", f"{key}_high")
    )
    return middle, np.stack([middle - low, high - middle])


def kinds_of(rows: Sequence[Row], key: str) -> str:
    """Name the kinds of the intervals of a measure."""
    return kinds_in_words(row[f"{key}_interval"] for row in rows)


def plain_ticks(axis: Axes) -> None:
    """Label a logarithmic y axis with 0.1, 0.2, 0.5, 1, ..."""
    plain_log_ticks(axis.yaxis)
