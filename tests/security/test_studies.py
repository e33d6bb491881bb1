"""Study files and folders of studies from elsewhere run no code and read no other policies than they name."""

import sys
from pathlib import Path

import pytest

from agent_proc.policies.registry import make_policy
from legpush.cli import main
from legpush.errors import PolicyError
from legpush.study.engines.trusted import Trusted
from legpush.study.jobs import Job, Task

MARK = "the code ran"
EVIL = f"""
import pathlib
pathlib.Path("ran").write_text("{MARK}")

def evil(seed: int = 0):
    return {{"value": 1.0}}
"""


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A working directory with a module whose import leaves a mark."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "evil_cells.py").write_text(EVIL)
    return tmp_path


@pytest.mark.parametrize(
    "text",
    [
        'cell = "evil_cells:evil"',
        'cell = "push"\n[settings]\npolicy = "evil_cells:evil"',
        'cell = "mission"\n[axes]\npolicy = ["scripted", "evil_cells:evil"]',
        'cell = "push"\n[settings]\npolicy = "evil.zip"',
    ],
)
def test_a_study_file_alone_runs_no_code(here: Path, text: str, capsys: pytest.CaptureFixture[str]) -> None:
    (here / "evil.zip").write_bytes(b"")
    (here / "study.toml").write_text(f'name = "evil"\n{text}\n')
    assert main(["study", "run", "study.toml"]) == 2
    assert "if you trust it" in capsys.readouterr().err
    assert not (here / "ran").exists()
    assert not (here / "runs").exists()


def test_the_folder_of_a_study_alone_runs_no_code(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (here / "study.toml").write_text('name = "own"\n')
    assert main(["study", "run", "study.toml", "--out", "out", "--cell", "evil_cells:evil", "--workers", "1"]) == 0
    assert (here / "ran").read_text() == MARK
    (here / "ran").unlink()
    sys.modules.pop("evil_cells")
    for command in (["status", "out"], ["verify", "out"], ["merge", "out", "out", "--out", "merged"]):
        main(["study", *command])
    assert "--cell" in capsys.readouterr().err
    assert not (here / "ran").exists()


@pytest.mark.parametrize("module", ["evil_cells", "evil-cells", "évil", "1st", "two words", " evil", "evil.py"])
@pytest.mark.parametrize("name", ["evil", "no function", "", "a:b"])
def test_a_policy_that_a_worker_does_not_refuse_runs_no_code(
    here: Path, module: str, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys, "path", [*sys.path])
    (here / f"{module}.py").write_text(EVIL)
    policy = f"{module}:{name}"
    task = Task(cell="c", inputs={}, specification={"policy": policy})
    if Trusted().objection(Job(kind="push", code="", canary=None, results=None, tasks=(task,))) is None:
        with pytest.raises(PolicyError):
            make_policy(policy)
        assert not (here / "ran").exists()
