from pathlib import Path

import msgspec
import pytest

from agent_proc.learning.plan_file import PROGRESS_FILE
from agent_proc.statistics.estimate import CUT
from agent_proc.statistics.intervals import STUDENT_T
from agent_proc.studies.seed_trainings import (
    MEASURES,
    STUDY,
    has_seeds,
    progress_text,
    seed_folder,
    seed_folders,
    study_text,
    summarize_seeds,
    write_summary,
)
from agent_proc.studies.training_cell import TRAINING
from legpush.errors import ConfigError
from legpush.study.carry_out import study_record
from legpush.study.file import read_study
from legpush.study.folder import StudyFolder
from legpush.study.rows import write_part


def test_the_study_has_a_cell_for_each_seed_and_only_what_was_given() -> None:
    study = read_study(study_text({"steps": 64, "task": None, "world": "map"}, [4, 2]), "here")
    assert study.kind is TRAINING
    assert [(task.inputs["seed"], task.inputs["steps"], task.inputs["world"]) for task in study.tasks()] == [
        (4, 64, "map"),
        (2, 64, "map"),
    ]


def test_the_summary_is_the_mean_over_the_seeds(tmp_path: Path) -> None:
    assert not has_seeds(tmp_path)
    study = read_study(study_text({"steps": 64}, [4, 2]), "here")
    (tmp_path / STUDY).mkdir()
    folder = StudyFolder(tmp_path / STUDY)
    with folder.opened((study.source,), study_record(study, [task.cell for task in study.tasks()], "again")):
        assert has_seeds(tmp_path)
        assert seed_folders(tmp_path) == {2: tmp_path / "seed-2", 4: tmp_path / "seed-4"}
        with pytest.raises(ConfigError, match="expected trainings that are done, got none"):
            summarize_seeds(tmp_path)
        for task, error_m in zip(study.tasks(), (0.01, 0.03), strict=True):
            numbers = {measure.column: 1.0 for measure in MEASURES} | {"position_error_m": error_m}
            write_part(folder.parts, [{"cell": task.cell, **numbers}])
    summary = summarize_seeds(tmp_path)
    assert list(summary) == [measure.column for measure in MEASURES]
    error = summary["position_error_m"]
    assert error.value == pytest.approx(0.02)
    assert (error.n, error.low, error.kind) == (2, 0.0, f"{STUDENT_T}, {CUT}")
    written = msgspec.json.decode(write_summary(tmp_path, summary).read_bytes())
    assert written["position_error_m"]["n"] == 2


def test_the_progress_names_the_trainings_that_are_under_way(tmp_path: Path) -> None:
    for seed, percent in ((1, 100), (2, 40)):
        seed_folder(tmp_path, seed).mkdir()
        (seed_folder(tmp_path, seed) / PROGRESS_FILE).write_text(f"{percent}\n")
    assert progress_text(tmp_path, [1, 2, 3]) == "seed 2 40 %"
