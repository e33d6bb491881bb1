"""A comparison as text, CSV and JSON."""

import csv
import io
from collections.abc import Iterator, Mapping
from dataclasses import asdict
from typing import Any, Final

import msgspec

from agent_proc.statistics.estimate import Estimate
from agent_proc.studies.comparison.outcome import COMPARED, LOSS, THRESHOLDS, Entry, Outcome

SHOWN: Final[Mapping[str, tuple[str, float, str]]] = {
    "success": ("success [%]", 100.0, ".0f"),
    "position_error_m": ("position [cm]", 100.0, ".2f"),
    "angle_error_deg": ("angle [°]", 1.0, ".2f"),
    LOSS: ("loss", 1.0, ".2f"),
    "n_cycles": ("cycles", 1.0, ".1f"),
    "simulated_s": ("time [s]", 1.0, ".0f"),
    "decision_cpu_s": ("decision [ms CPU]", 1000.0, ".2f"),
}
"""Title, scale and format of each measure on a screen."""
Cells = list[list[str]]


def entry_cells(outcome: Outcome) -> Cells:
    """Titles, and a row for each contestant."""
    titles = ["", "trainings", "starts", *(title for title, _, _ in SHOWN.values()), "loss, IQM", "falls"]
    return [titles, *(_entry_row(entry) for entry in outcome.entries)]


def versus_cells(outcome: Outcome) -> Cells:
    """Titles, and a row for each contestant but the one that they are compared with."""
    titles = [f"minus {outcome.against}", *(SHOWN[name][0] for name in COMPARED), "P(lower loss)"]
    rows = [
        [each.label, *(_cell(name, each.differences[name]) for name in COMPARED), f"{each.improvement:.2f}"]
        for each in outcome.versus
    ]
    return [titles, *rows]


def kinds(outcome: Outcome) -> list[str]:
    """The kinds of all intervals, each once."""
    estimates = [estimate for entry in outcome.entries for estimate in (*entry.means.values(), entry.loss_iqm)]
    estimates += [each for versus in outcome.versus for each in (*versus.differences.values(), versus.improvement)]
    return list(dict.fromkeys(estimate.kind for estimate in estimates))


def as_csv(outcome: Outcome) -> str:
    """One line for each number: contestant, statistic, value, low, high, kind of interval, trainings and starts."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["contestant", "against", "statistic", "value", "low", "high", "interval", "trainings", "starts"])
    sizes = {entry.label: (entry.n_trainings, entry.n_starts) for entry in outcome.entries}
    for label, against, statistic, estimate in _numbers(outcome):
        numbers = (estimate.value, estimate.low, estimate.high, estimate.kind)
        writer.writerow([label, against, statistic, *numbers, *sizes[label]])
    return text.getvalue()


def as_json(outcome: Outcome, about: Mapping[str, Any]) -> bytes:
    """Everything, with `about` at its head."""
    plain = {**about, "loss_thresholds": THRESHOLDS, **asdict(outcome)}
    return msgspec.json.format(msgspec.json.encode(plain), indent=1) + b"\n"


def _entry_row(entry: Entry) -> list[str]:
    means = (_cell(name, entry.means[name]) for name in SHOWN)
    sizes = (str(entry.n_trainings), str(entry.n_starts))
    return [entry.label, *sizes, *means, f"{entry.loss_iqm:.2f}", str(entry.falls)]


def _cell(name: str, estimate: Estimate) -> str:
    _, scale, number = SHOWN[name]
    return f"{estimate.scaled(scale):{number}}"


def _numbers(outcome: Outcome) -> Iterator[tuple[str, str, str, Estimate]]:
    for entry in outcome.entries:
        for name, estimate in entry.means.items():
            yield entry.label, "", f"mean of {name}", estimate
        yield entry.label, "", "IQM of loss", entry.loss_iqm
    for versus in outcome.versus:
        for name, estimate in versus.differences.items():
            yield versus.label, outcome.against, f"mean difference of {name}", estimate
        yield versus.label, outcome.against, "probability of a lower loss", versus.improvement


def as_text(cells: Cells) -> str:
    """The cells as lines: the first column to the left, the others to the right."""
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    lines = []
    for first, *others in cells:
        right = (word.rjust(width) for word, width in zip(others, widths[1:], strict=True))
        lines.append("  ".join((first.ljust(widths[0]), *right)))
    return "\n".join(lines)
