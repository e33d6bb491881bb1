"""The SHA-256 of policies of all kinds."""

import hashlib
import shutil
from pathlib import Path

import pytest

from agent_proc.policies.digest import policy_sha256
from agent_proc.policies.folder import policy_path
from legpush.errors import PolicyError


def test_a_copy_of_a_folder_has_the_same_hash_until_one_of_its_files_changes(tmp_path: Path) -> None:
    shutil.copytree(policy_path("variable"), tmp_path / "copy")
    shipped = policy_sha256("variable")

    assert policy_sha256(str(tmp_path / "copy")) == shipped
    (tmp_path / "copy" / "README.md").write_text("other words")
    assert policy_sha256(str(tmp_path / "copy")) == shipped
    (tmp_path / "copy" / "policy.safetensors").write_text("{}")
    assert policy_sha256(str(tmp_path / "copy")) != shipped


def test_the_hash_of_a_model_file_is_that_of_its_bytes(tmp_path: Path) -> None:
    (tmp_path / "model.zip").write_bytes(b"bytes")

    assert policy_sha256(str(tmp_path / "model.zip")) == hashlib.sha256(b"bytes").hexdigest()


def test_code_has_the_hash_of_its_source_and_the_scripted_policy_has_none() -> None:
    source = Path(__file__).read_bytes()

    assert policy_sha256("tests.agent.policies.test_digest:anything") == hashlib.sha256(source).hexdigest()
    assert policy_sha256("scripted") == ""


@pytest.mark.parametrize("name", ["nobody", "none.zip"])
def test_what_is_not_there_has_no_hash(name: str) -> None:
    with pytest.raises(PolicyError, match=f"{name}"):
        policy_sha256(name)
