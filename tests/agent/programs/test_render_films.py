import io
import subprocess
from pathlib import Path

import pytest
from rich.console import Console

from agent_proc.learning.films import FILMS, JOURNAL_FILE
from agent_proc.programs.render_films import render_films
from legpush.errors import NO_OPENGL


def places(folder: Path, *names: str) -> list[Path]:
    found = [folder / FILMS / name for name in names]
    for place in found:
        place.mkdir(parents=True)
        (place / JOURNAL_FILE).touch()
    return found


def said(folder: Path) -> list[str]:
    console = Console(file=io.StringIO(), width=400)
    render_films(folder, console)
    return str(console.file.getvalue()).splitlines()  # type: ignore[attr-defined]


def test_every_episode_without_a_film_is_filmed_and_a_failure_is_said(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    first, second = places(tmp_path, "step-1", "step-2")
    answers = iter([(0, ""), (3, "a line\nerror: no ffmpeg\n")])

    def run(command: list[str], **_: object) -> subprocess.CompletedProcess[str]:
        assert command[1:4] == ["-P", "-m", "sim_proc.render"]
        code, stderr = next(answers)
        return subprocess.CompletedProcess(command, code, "", stderr)

    monkeypatch.setattr(subprocess, "run", run)
    assert said(tmp_path) == [f"wrote {first / 'mission.mp4'}", f"no film of {second}: error: no ffmpeg"]


def test_without_opengl_one_line_says_so(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    places(tmp_path, "step-1", "step-2")
    done = subprocess.CompletedProcess([], NO_OPENGL, "", "no OpenGL library\n")
    monkeypatch.setattr(subprocess, "run", lambda *_, **__: done)
    assert len(said(tmp_path)) == 1
    assert said(tmp_path / "nothing") == []
