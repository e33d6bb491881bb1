"""Evaluations for the studies: each is one `legpush evaluate`, and its rows stay in `results/evaluations/`."""

import csv
import gzip
import io
import json
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import LogLocator, NullFormatter

from agent_proc.statistics.estimate import kinds_in_words
from agent_proc.statistics.intervals import mean, share
from legpush.arrays import Floats

RESULTS: Final = Path(__file__).parent / "results"
EVALUATIONS: Final = RESULTS / "evaluations"


@dataclass(frozen=True, kw_only=True)
class Evaluation:
    """One evaluation; `name` names its files."""

    name: str
    policy: str
    sweeps: tuple[str, ...] = ()
    grid: bool = False
    episodes: int
    """Number of episodes for each case."""
    first_seed: int

    def command(self, out: Path) -> list[str]:
        """Return the arguments of `legpush`."""
        arguments = ["evaluate", self.policy, "--episodes", str(self.episodes), "--first-seed", str(self.first_seed)]
        for sweep in self.sweeps:
            arguments += ["--sweep", sweep]
        return [*arguments, *["--grid"][: self.grid], "--out", str(out)]


def run_missing(evaluations: Sequence[Evaluation], *, again: bool = False) -> None:
    """Carry out the evaluations that have no rows yet, one after the other; with `again`, all of them."""
    EVALUATIONS.mkdir(parents=True, exist_ok=True)
    for evaluation in evaluations:
        if again or not (EVALUATIONS / f"{evaluation.name}.csv").exists():
            _run(evaluation)


def _run(evaluation: Evaluation) -> None:
    with tempfile.TemporaryDirectory(prefix="legpush-evaluation-") as scratch:
        out = Path(scratch) / evaluation.name
        command = [str(Path(sys.executable).with_name("legpush")), *evaluation.command(out)]
        done = subprocess.run(command, check=False)
        if done.returncode != 0:
            raise SystemExit(f"{evaluation.name}: legpush evaluate exited with {done.returncode}")
        shutil.copy(out / "episodes.csv", EVALUATIONS / f"{evaluation.name}.csv")
        summary = json.loads((out / "summary.json").read_text())
        summary["command"] = " ".join(["legpush", *evaluation.command(Path("DIR"))])
        (EVALUATIONS / f"{evaluation.name}.json").write_text(json.dumps(summary, indent=1) + "\n")


def read_rows(name: str) -> list[dict[str, Any]]:
    """Return the episodes of an evaluation, with numbers as floats."""
    return [{key: _value(value) for key, value in row.items()} for row in read_table(EVALUATIONS / f"{name}.csv")]


def _value(text: str) -> float | str | bool:
    if text in ("True", "False"):
        return text == "True"
    try:
        return float(text)
    except ValueError:
        return text


def summary_columns(episodes: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """Summarize the episodes of one case: means with 95 % intervals and their kinds, counts and extremes."""
    n = len(episodes)
    return {
        "n": n,
        **mean([row["position_error_m"] for row in episodes]).columns("position_error_m", 5),
        **mean([row["angle_error_deg"] for row in episodes]).columns("angle_error_deg", 3),
        **share(sum(row["success"] for row in episodes), n).columns("success_rate", 4),
        "falls": sum(row["ending"] == "fell" for row in episodes),
        "cycles": round(sum(row["n_cycles"] for row in episodes) / n, 2),
        "max_abs_roll_deg": round(max(row["max_abs_roll_deg"] for row in episodes), 2),
        "max_abs_pitch_deg": round(max(row["max_abs_pitch_deg"] for row in episodes), 2),
        "min_support_margin_m": round(min(row["min_support_margin_m"] for row in episodes), 4),
    }


def write_table(rows: Sequence[dict[str, Any]], path: Path) -> None:
    """Write rows as CSV, with the keys of the first row as columns; compress if the path ends in `.gz`."""
    text = io.StringIO()
    writer = csv.DictWriter(text, list(rows[0]), lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    data = text.getvalue().encode()
    path.write_bytes(gzip.compress(data, mtime=0) if path.suffix == ".gz" else data)


def read_table(path: Path) -> list[dict[str, str]]:
    """Return the rows of a table as text; no rows if the file does not exist."""
    if not path.exists():
        return []
    data = path.read_bytes()
    text = (gzip.decompress(data) if path.suffix == ".gz" else data).decode()
    return list(csv.DictReader(io.StringIO(text)))


def errors_of(rows: Sequence[dict[str, Any]], key: str, scale: float = 1.0) -> tuple[Floats, Floats]:
    """Return the estimates of a measure, (n,), and how far their intervals reach below and above them, (2, n), as
    `errorbar` takes them; nan, which is not drawn, without an interval."""
    middle, low, high = (
        scale * np.array([row[name] for row in rows], dtype=np.float64) for name in (key, f"{key}_low", f"{key}_high")
    )
    return middle, np.stack([middle - low, high - middle])


def kinds_of(rows: Sequence[dict[str, Any]], key: str) -> str:
    """Name the kinds of the intervals of a measure."""
    return kinds_in_words(row[f"{key}_interval"] for row in rows)


def plain_ticks(axis: Axes) -> None:
    """Label a logarithmic y axis with 0.1, 0.2, 0.5, 1, ..."""
    axis.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axis.yaxis.set_major_formatter("{x:g}")
    axis.yaxis.set_minor_formatter(NullFormatter())
