import base64
import io
import zipfile
from pathlib import Path

import msgspec
import pytest

from agent_proc.policies.folder import read_policy
from agent_proc.studies.training_cell import TRAINING, TrainingCell, pack, resolve
from legpush.errors import ConfigError
from legpush.study.cells import columns_of


def test_a_training_returns_its_best_policy(tmp_path: Path) -> None:
    resolved = resolve(TrainingCell(steps=16, n_simulators=2, changes={"mission.max_push_cycles": 4}), ())
    profile = {**resolved.profile, "evaluation_episodes": 1, "evaluate_every": 16}
    profile["settings"] = {**profile["settings"], "n_steps": 8, "batch_size": 8}
    small = msgspec.structs.replace(resolved, profile=profile)
    columns = columns_of(TRAINING, small)
    assert columns["best_step"] <= columns["steps_done"] == 16
    assert list(columns) == [column.name for column in TRAINING.columns]
    with zipfile.ZipFile(io.BytesIO(base64.b64decode(columns["policy_zip"]))) as archive:
        archive.extractall(tmp_path / "policy")
    card = read_policy(tmp_path / "policy").card
    assert (card.steps, card.seed, card.n_simulators) == (columns["best_step"], 0, 2)


def test_a_resolved_cell_comes_back_from_plain_values() -> None:
    resolved = resolve(TrainingCell(profile="sac", mass_kg=(0.1, 0.5)), ())
    assert msgspec.convert(msgspec.to_builtins(resolved), TRAINING.resolved) == resolved


def test_an_unknown_profile_is_refused() -> None:
    with pytest.raises(ConfigError, match="Expected the name of a profile"):
        resolve(TrainingCell(profile="best"), ())


def test_files_are_packed_by_name(tmp_path: Path) -> None:
    (tmp_path / "b").write_text("2")
    (tmp_path / "a").write_text("1")
    with zipfile.ZipFile(io.BytesIO(base64.b64decode(pack(tmp_path)))) as archive:
        assert archive.namelist() == ["a", "b"]
        assert archive.read("b") == b"2"
