from pathlib import Path

import pytest

from legpush.study import identity
from legpush.study.identity import cell_identity, code_version, study_versions, versions_hash


def test_the_identity_does_not_depend_on_the_order_of_fields() -> None:
    assert cell_identity("push", {"a": 1, "b": 2.0}, "c") == cell_identity("push", {"b": 2.0, "a": 1}, "c")


def test_kind_specification_and_code_make_the_identity() -> None:
    cells = {
        cell_identity("push", {"a": 1}, "c"),
        cell_identity("plan", {"a": 1}, "c"),
        cell_identity("push", {"a": 2}, "c"),
        cell_identity("push", {"a": 1}, "d"),
    }
    assert len(cells) == 4


def test_the_code_version_follows_every_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    package = tmp_path / "some_package"
    package.mkdir()
    (package / "__init__.py").write_text("")
    (package / "data.toml").write_text("a = 1")
    (package / "__pycache__" / "kernels").mkdir(parents=True)
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setattr(identity, "PACKAGES", ("some_package", "not_installed"))
    versions: list[str] = []
    for text in ("a = 1", "a = 2", "a = 1"):
        (package / "data.toml").write_text(text)
        for compiled in ("module.pyc", "__pycache__/module.pyc.140", "__pycache__/kernels/kernel.nbc"):
            (package / compiled).write_text(str(len(versions)))
        versions.append(code_version.__wrapped__("push"))
    assert versions[0] == versions[2] != versions[1]


def test_a_users_own_cell_is_part_of_the_code() -> None:
    assert code_version("push") == code_version("plan") != code_version("tests.legpush.study.stub:STUB")


def test_the_versions_name_the_c_library() -> None:
    assert study_versions()["libc"]
    assert len(versions_hash()) == identity.N_DIGITS
