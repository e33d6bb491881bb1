"""Evaluations that the studies share: each is one `legpush evaluate`, and its rows stay in `results/evaluations/`."""

import csv
import json
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

RESULTS: Final = Path(__file__).parent / "results"
EVALUATIONS: Final = RESULTS / "evaluations"


@dataclass(frozen=True, kw_only=True)
class Evaluation:
    """What is evaluated; `name` is what its files are called."""

    name: str
    policy: str
    sweeps: tuple[str, ...] = ()
    grid: bool = False
    episodes: int
    """For each case."""
    first_seed: int

    def command(self, out: Path) -> list[str]:
        """The arguments of `legpush`."""
        arguments = ["evaluate", self.policy, "--episodes", str(self.episodes), "--first-seed", str(self.first_seed)]
        for sweep in self.sweeps:
            arguments += ["--sweep", sweep]
        return [*arguments, *["--grid"][: self.grid], "--out", str(out)]


def run_missing(evaluations: Sequence[Evaluation], *, again: bool = False) -> None:
    """Carry out those that have no rows yet, one after the other, or all of them `again`."""
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
    """The episodes of an evaluation, numbers as numbers."""
    with (EVALUATIONS / f"{name}.csv").open(newline="") as file:
        return [{key: _value(value) for key, value in row.items()} for row in csv.DictReader(file)]


def _value(text: str) -> float | str | bool:
    if text in ("True", "False"):
        return text == "True"
    try:
        return float(text)
    except ValueError:
        return text
