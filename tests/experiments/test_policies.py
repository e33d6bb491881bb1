"""The best policies of trainings are unpacked under the names that other studies use."""

import base64
import io
import tomllib
import zipfile
from pathlib import Path

import pyarrow
import pytest

from docs.study_list import ROOT
from experiments import policies
from legpush.errors import ConfigError
from legpush.study.folder import StudyFolder, StudyRecord
from legpush.study.rows import write_table

RECORD = StudyRecord(
    name="training_randomized",
    kind="training",
    n_cells=2,
    cells_sha256="",
    code="c0de",
    inputs=("seed",),
    axes=("seed",),
    may_differ=("policy_zip",),
    units={},
    canary=None,
    versions={},
    command="",
)


def packed(text: str) -> str:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as archive:
        archive.writestr("card.json", text)
    return base64.b64encode(buffer.getvalue()).decode()


def trainings(path: Path, **columns: list[object]) -> Path:
    folder = StudyFolder(path)
    with folder.opened(("",), RECORD):
        pass
    write_table(pyarrow.table({"cell": ["a", "b"], "seed": [1, 2], **columns}), folder.table)
    return path


def test_each_policy_goes_into_its_own_folder(tmp_path: Path) -> None:
    folder = trainings(tmp_path / "study", policy_zip=[packed("one"), packed("two")])

    assert policies.main(policies.Config(folder=folder, out=tmp_path / "policies")) == 0

    for seed, text in ((1, "one"), (2, "two")):
        assert (tmp_path / "policies" / f"training_randomized-{seed}" / "card.json").read_text() == text


def test_the_study_of_the_randomized_policy_takes_it_from_there() -> None:
    study = tomllib.loads((ROOT / "experiments" / "studies" / "unseen_randomized.toml").read_text())

    assert Path(study["settings"]["policy"]) == policies.Config(folder=Path()).out / "training_randomized-1"


def test_a_study_without_policies_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="expected a study of trainings with rows"):
        policies.main(policies.Config(folder=trainings(tmp_path / "study"), out=tmp_path))
