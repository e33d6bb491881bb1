"""Results of a soak: a JSON file that says how it was made, and a table for people."""

import os
import platform
import shlex
import subprocess
import sys
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from pathlib import Path
from statistics import median
from typing import Any, Final

import msgspec
from msgspec import Struct

from legpush.files import write_whole
from legpush.soak.cell_run import CellResult
from legpush.soak.steps import StepsResult
from legpush.soak.table import KINDS
from legpush.soak.timing import Times
from legpush.soak.training import TrainingResult
from legpush.versions import installed_versions

RESULTS_FILE: Final = "soak.json"
PARTS: Final = tuple(Times.__struct_fields__)


class Summary(Struct, frozen=True, kw_only=True):
    """The cells of one kind of fault, or of all."""

    n_cells: int
    n_survived: int
    n_same: int
    n_as_expected: int


class TimeSummary(Struct, frozen=True, kw_only=True):
    """Seconds of one part of the kills of a role."""

    n: int
    median_s: float
    longest_s: float


class SoakResults(Struct, kw_only=True):
    """Everything that a soak has found up to now."""

    made: dict[str, dict[str, Any]]
    summary: dict[str, Summary] = {}
    """By kind of fault, and of `all`."""
    kills: dict[str, dict[str, TimeSummary]] = {}
    """By role, and by part of the times."""
    steps: list[StepsResult] = []
    training: TrainingResult | None = None
    cells: list[CellResult] = []

    def summarize(self) -> None:
        """Make the summaries from the cells."""
        kinds = {kind: [cell for cell in self.cells if cell.name.split("-")[0] == kind] for kind in KINDS}
        groups = [("all", self.cells), *kinds.items()]
        self.summary = {name: _summary(cells) for name, cells in groups if cells}
        killed = [cell for cell in kinds["kill"] if cell.times is not None]
        roles = dict.fromkeys(cell.name.split("-")[1] for cell in killed)
        self.kills = {role: _times(c.times for c in killed if c.name.split("-")[1] == role) for role in roles}

    @property
    def is_as_expected(self) -> bool:
        """Whether nothing differs from what is expected."""
        return (
            all(cell.is_as_expected for cell in self.cells)
            and all(steps.is_flat for steps in self.steps)
            and (self.training is None or self.training.is_same)
        )


def read_results(folder: Path) -> SoakResults:
    """Return the results in a folder, or empty ones that say how they will be made."""
    path = folder / RESULTS_FILE
    if path.exists():
        return msgspec.json.decode(path.read_bytes(), type=SoakResults)
    return SoakResults(made={"soak": made_here()})


def write_results(folder: Path, results: SoakResults) -> None:
    """Write the results into a folder."""
    results.summarize()
    write_whole(folder / RESULTS_FILE, msgspec.json.format(msgspec.json.encode(results), indent=1) + b"\n")


def made_here() -> dict[str, Any]:
    """Return how the results of this process are made."""
    versions = {name: version for name, version in installed_versions().items() if version is not None}
    return {
        "version": versions.get("legpush", "?"),
        "commit": _commit(),
        "command": shlex.join(["legpush", *_without_folder(sys.argv[1:])]),
        "machine": f"{platform.machine()}, {len(os.sched_getaffinity(0))} cores",
        "versions": versions,
    }


def table_lines(results: SoakResults) -> list[str]:
    """Return the results for people."""
    head = f"{'fault':<16}{'cells':>6}{'survived':>10}{'same state':>12}{'as expected':>13}"
    lines = [head] if results.summary else []
    for name, one in results.summary.items():
        lines.append(f"{name:<16}{one.n_cells:>6}{one.n_survived:>10}{one.n_same:>12}{one.n_as_expected:>13}")
    for role, parts in results.kills.items():
        lines += ["", f"{role} killed, ms{'n':>23}{'median':>9}{'longest':>9}"]
        for part, time in parts.items():
            name = part.removesuffix("_s").replace("_", " ")
            lines.append(f"  {name:<27}{time.n:>8}{1e3 * time.median_s:>9.1f}{1e3 * time.longest_s:>9.1f}")
    for steps in results.steps:
        lines += ["", f"{steps.n_steps} steps at {steps.steps_per_s:g} per second"]
        for name, growth in steps.growth.items():
            lines.append(f"  {name}: {_growth_words(growth)}")
    if (training := results.training) is not None:
        words = "the same" if training.is_same else f"other {', '.join(training.different_files)}"
        lines += [
            "",
            f"training of {training.hours:g} h, {training.n_steps} steps, {training.killed_simulators} simulators and "
            f"{training.killed_learners} learners killed: {words} as without",
        ]
    return lines


def _without_folder(words: Sequence[str]) -> list[str]:
    """Return a command line without the folder of its results, which says nothing about them."""
    folder = words.index("--out") if "--out" in words else len(words)
    return [*words[:folder], *words[folder + 2 :]]


def _growth_words(growth: Any) -> str:
    if growth is None:
        return "too few samples"
    return (
        f"{growth.memory_mb:.1f} MB, {100 * growth.memory:+.2f} %, {growth.threads:+d} threads, {growth.files:+d} files"
    )


def _summary(cells: Sequence[CellResult]) -> Summary:
    count: Callable[[str], int] = lambda field: sum(getattr(cell, field) for cell in cells)  # noqa: E731
    return Summary(
        n_cells=len(cells),
        n_survived=count("survived"),
        n_same=count("same"),
        n_as_expected=count("is_as_expected"),
    )


def _times(times: Iterable[Times | None]) -> dict[str, TimeSummary]:
    measured = [one for one in times if one is not None]
    found = {}
    for part in PARTS:
        values = [value for one in measured if (value := getattr(one, part)) is not None]
        if values:
            found[part] = TimeSummary(n=len(values), median_s=round(median(values), 4), longest_s=max(values))
    return found


def _commit() -> str:
    """Return the commit of the checkout that this package is in; empty if it is in none."""
    here = Path(__file__).parent
    with suppress(OSError, subprocess.CalledProcessError):
        command = ["git", "-C", str(here), "rev-parse", "--short", "HEAD"]
        return subprocess.run(command, check=True, capture_output=True, text=True).stdout.strip()
    return ""
