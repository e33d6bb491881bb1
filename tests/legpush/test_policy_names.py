"""Kinds of policies by their names, and the sources of those that are code."""

import hashlib
import sys
from pathlib import Path

import pytest

from legpush import policy_names
from legpush.errors import PolicyError
from legpush.policy_names import policy_kind, require_repeated, require_trust, runs_code, source_sha256


@pytest.mark.parametrize(
    ("name", "kind"),
    [
        ("scripted", "own"),
        ("variable", "own"),
        ("my_policy/best", "folder"),
        ("no such thing", "folder"),
        ("/abs/model.zip", "model file"),
        ("module:function", "module:function"),
        ("module:function.zip", "module:function"),
    ],
)
def test_the_name_says_the_kind_and_only_folders_and_own_policies_run_no_code(name: str, kind: str) -> None:
    assert policy_kind(name) == kind
    assert runs_code(name) == (kind not in ("own", "folder"))


@pytest.mark.parametrize("name", ["of_others", "scripted"])
def test_a_plug_in_of_another_package_is_code_also_under_a_name_of_this_package(
    monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    values = {"of_others": ("others.policies:make",), "scripted": ("agent_proc.policies:x", "others.policies:make")}
    monkeypatch.setattr(policy_names, "plugin_values", lambda _, name: values[name])

    assert policy_kind(name) == "plug-in"
    assert runs_code(name)


def test_code_of_a_recording_has_to_be_repeated_word_by_word() -> None:
    require_repeated("scripted", None)
    require_repeated("evil:go", "evil:go")
    for repeated in (None, "evil:gone", "scripted"):
        with pytest.raises(PolicyError, match="with the policy evil:go, which runs code: repeat it with --policy evil"):
            require_repeated("evil:go", repeated)


def test_a_model_file_has_to_be_trusted() -> None:
    require_trust("model.zip", True)
    require_trust("variable", False)
    with pytest.raises(PolicyError, match=r"model\.zip: expected --trust-policy-file .* pickle"):
        require_trust("model.zip", False)


def test_the_source_of_a_function_is_hashed_and_not_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    trap = "raise SystemExit('was imported')"
    (tmp_path / "hashed_package" / "inner").mkdir(parents=True)
    for file in ("hashed_package/__init__.py", "hashed_package/inner/__init__.py", "hashed_package/inner/policy.py"):
        (tmp_path / file).write_text(f"{trap}  # {file}")
    (tmp_path / "hashed_alone.py").write_text(trap)
    monkeypatch.chdir(tmp_path)
    before = (list(sys.path), set(sys.modules))

    def sha256(file: str) -> str:
        return hashlib.sha256((tmp_path / file).read_bytes()).hexdigest()

    assert source_sha256("hashed_alone:go") == sha256("hashed_alone.py")
    assert source_sha256("hashed_package:go") == sha256("hashed_package/__init__.py")
    assert source_sha256("hashed_package.inner:go") == sha256("hashed_package/inner/__init__.py")
    assert source_sha256("hashed_package.inner.policy:go") == sha256("hashed_package/inner/policy.py")
    assert (sys.path, set(sys.modules)) == before


@pytest.mark.parametrize("address", ["no_such_module:go", ":go", ".:go", "math.inner:go", "sys:go"])
def test_what_has_no_source_has_no_hash(address: str) -> None:
    assert source_sha256(address) == ""
