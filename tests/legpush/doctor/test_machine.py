"""What `legpush doctor` says about sockets, folders and OpenGL."""

import subprocess
from pathlib import Path

import pytest

from legpush.bus import endpoints
from legpush.doctor.machine import folder_findings, opengl_finding, resource_findings, socket_findings


def test_a_directory_of_sockets_that_others_may_enter_gets_a_note(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(endpoints, "own_directory", lambda: tmp_path / "own")
    assert next(socket_findings()).state == "ok"
    (tmp_path / "own").chmod(0o755)
    found = next(socket_findings())
    assert found.state == "note"
    assert "0755" in found.detail


def test_a_folder_that_cannot_be_written_to_is_missing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "runs").touch()
    temporary, results = folder_findings()
    assert temporary.state in ("ok", "note")
    assert results.state == "missing"
    assert str(tmp_path / "runs") in results.detail


@pytest.mark.parametrize(
    ("printed", "state", "words"),
    [
        (b'{"backend": "egl", "failures": []}', "ok", "egl draws"),
        (b'{"backend": null, "failures": ["egl: no device"]}', "note", "egl: no device"),
        (b'{"backend": null, "failures": []}', "note", "forbids"),
        (b"", "note", "without the simulator's libraries"),
    ],
)
def test_opengl_is_what_the_probe_says(printed: bytes, state: str, words: str, monkeypatch: pytest.MonkeyPatch) -> None:
    def run(command: list[str], **_: object) -> subprocess.CompletedProcess[bytes]:
        return subprocess.CompletedProcess(command, 0, printed)

    monkeypatch.setattr(subprocess, "run", run)
    found = opengl_finding()
    assert found.state == state
    assert words in found.detail


def test_cores_memory_files_and_runs_are_told() -> None:
    assert [finding.name for finding in resource_findings()] == ["cores", "memory", "open files", "live runs"]
