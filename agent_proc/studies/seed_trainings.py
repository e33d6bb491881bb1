"""Trainings that differ by their seed alone: a study, and beside it a folder for each training.

`OUT/study` is the folder of the study, and `OUT/seed-N` that of the training with the seed N, in which it goes on.
"""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from math import inf
from pathlib import Path
from typing import Any, Final

import msgspec
import msgspec.toml
import tomli_w

from agent_proc.learning.plan_file import PROGRESS_FILE
from agent_proc.statistics.estimate import Estimate
from agent_proc.statistics.intervals import mean
from legpush.errors import ConfigError
from legpush.files import write_whole
from legpush.study.folder import STUDY_FILE, StudyFolder

STUDY: Final = "study"
SUMMARY_FILE: Final = "summary.json"


@dataclass(frozen=True, kw_only=True)
class Measure:
    """A result of a training as the summary shows it."""

    column: str
    name: str
    unit: str = ""
    scale: float = 1.0
    """From the unit of the column to `unit`."""
    n_digits: int = 2
    most: float = inf


MEASURES: Final = (
    Measure(column="success_rate", name="success", unit="%", scale=100.0, n_digits=0, most=1.0),
    Measure(column="position_error_m", name="position error", unit="cm", scale=100.0),
    Measure(column="angle_error_deg", name="angle error", unit="°"),
    Measure(column="falls", name="falls"),
    Measure(column="cycles", name="push cycles", n_digits=1),
)


def has_seeds(folder: Path) -> bool:
    """Whether this is the folder of trainings with several seeds."""
    return (folder / STUDY / STUDY_FILE).is_file()


def study_text(settings: Mapping[str, Any], seeds: Sequence[int]) -> str:
    """The study file of trainings with these settings of a cell; those that are None are left out."""
    given = {name: value for name, value in settings.items() if value is not None}
    return tomli_w.dumps({"name": "seeds", "cell": "training", "settings": given, "axes": {"seed": list(seeds)}})


def seed_folder(folder: Path, seed: int) -> Path:
    """Folder of the training with this seed."""
    return folder / f"seed-{seed}"


def seed_folders(folder: Path) -> dict[int, Path]:
    """Folders of all trainings by their seed, in the order of the seeds, whether they are done or not."""
    (path,) = StudyFolder(folder / STUDY).sources()
    seeds = msgspec.toml.decode(path)["axes"]["seed"]
    return {seed: seed_folder(folder, seed) for seed in sorted(seeds)}


def progress_text(folder: Path, seeds: Sequence[int]) -> str:
    """How far the trainings are that have begun and are not done, such as `seed 1 40 %, seed 2 38 %`."""
    found: list[str] = []
    for seed in seeds:
        try:
            percent = (seed_folder(folder, seed) / PROGRESS_FILE).read_text(encoding="ascii").strip()
        except OSError:
            continue
        if percent != "100":
            found.append(f"seed {seed} {percent} %")
    return ", ".join(found)


def summarize_seeds(folder: Path) -> dict[str, Estimate]:
    """Means over the seeds of what the best policy of each training reached in its evaluation, by column.

    Raises:
        ConfigError: No training is done.
    """
    table = StudyFolder(folder / STUDY).rows()
    if table is None:
        raise ConfigError(f"{folder}: expected trainings that are done, got none")
    rows = table.to_pylist()
    return {each.column: mean([float(row[each.column]) for row in rows]).cut(0.0, each.most) for each in MEASURES}


def write_summary(folder: Path, summary: Mapping[str, Estimate]) -> Path:
    """Write the summary as JSON, in the units of the columns; returns the file.

    Raises:
        DiskError: It cannot be written.
    """
    path = folder / SUMMARY_FILE
    plain = {column: asdict(estimate) for column, estimate in summary.items()}
    write_whole(path, msgspec.json.format(msgspec.json.encode(plain), indent=1) + b"\n")
    return path
