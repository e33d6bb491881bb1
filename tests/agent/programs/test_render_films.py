"""Films of a training: what is said of each, and an interruption."""

import io
import sys
import threading
from pathlib import Path

import pytest
from rich.console import Console

from agent_proc.learning.films import FILMS, JOURNAL_FILE
from agent_proc.programs import render_films as program
from agent_proc.programs.render_films import render_films
from legpush.errors import NO_OPENGL

AGAIN = "legpush train --resume t"


def places(folder: Path, *names: str) -> list[Path]:
    found = [folder / FILMS / name for name in names]
    for place in found:
        place.mkdir(parents=True)
        (place / JOURNAL_FILE).touch()
    return found


def said(folder: Path, stop: threading.Event | None = None) -> list[str]:
    console = Console(file=io.StringIO(), width=400)
    assert render_films(folder, console, AGAIN, stop or threading.Event()) is (stop is None)
    return str(console.file.getvalue()).splitlines()  # type: ignore[attr-defined]


@pytest.fixture
def renderer(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The file of a program in the place of that which makes a film; it gets the folder of the episode last."""
    file = tmp_path / "renderer"
    monkeypatch.setattr(sys, "executable", str(file))

    return file


def write(renderer: Path, script: str) -> None:
    renderer.write_text(f"#!/bin/sh\n{script}\n")
    renderer.chmod(0o755)


def test_every_episode_without_a_film_is_filmed_and_a_failure_is_said(tmp_path: Path, renderer: Path) -> None:
    first, second = places(tmp_path, "step-1", "step-2")
    fails = 'case $4 in *2) echo "a line\nno ffmpeg" >&2; exit 3;; esac'
    write(renderer, f'test "$1 $2 $3" = "-P -m sim_proc.render" || exit 9\n{fails}')
    assert said(tmp_path) == [
        f"wrote {first / 'mission.mp4'}",
        f"no film of {second}: no ffmpeg; to try again: {AGAIN}",
    ]


def test_without_opengl_one_line_says_so(tmp_path: Path, renderer: Path) -> None:
    first, _ = places(tmp_path, "step-1", "step-2")
    write(renderer, f'echo "no OpenGL library" >&2; exit {NO_OPENGL}')
    assert said(tmp_path) == [f"no film of {first}: no OpenGL library; to try again: {AGAIN}"]
    assert said(tmp_path / "nothing") == []


def test_an_interruption_names_the_command_that_goes_on(
    tmp_path: Path, renderer: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    places(tmp_path, "step-1", "step-2")
    write(renderer, "exec sleep 60")
    stop = threading.Event()
    threading.Timer(2 * program.LOOK_S, stop.set).start()
    assert said(tmp_path, stop) == [f"interrupted: films are missing; to make them: {AGAIN}"]
    write(renderer, "trap '' TERM\nwhile true; do sleep 0.1; done")
    monkeypatch.setattr(program, "END_S", 0.3)
    assert said(tmp_path, stop) == [f"interrupted: films are missing; to make them: {AGAIN}"]


def test_a_film_that_takes_too_long_is_given_up(
    tmp_path: Path, renderer: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (place,) = places(tmp_path, "step-1")
    write(renderer, "exec sleep 60")
    monkeypatch.setattr(program, "LONGEST_S", 0.3)
    assert said(tmp_path) == [f"no film of {place}: it was not ready after 0.3 s; to try again: {AGAIN}"]
