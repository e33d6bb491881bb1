"""Films of recorded episodes: as many frames, of the size and for as long as was asked for."""

import os
from pathlib import Path

import imageio_ffmpeg
import numpy as np
import pytest
from PIL import Image

from legpush.errors import ConfigError, StopRequestedError
from legpush.options.export import ExportOptions
from sim_proc.export.films import take_of
from sim_proc.export.source import Source
from sim_proc.render import rendering
from sim_proc.render.backends import working_backend
from sim_proc.render.film import Film, film_of
from tests.sim.export.program import export


@pytest.fixture
def film(source: Source) -> Film:
    return film_of(source.episodes[0].timeline, "here")


def options(name: str, **given: object) -> ExportOptions:
    return ExportOptions(files=(Path("a.mcap"),), out=Path(name), **given)  # type: ignore[arg-type]


def test_a_film_begins_and_ends_when_it_is_told_to(film: Film) -> None:
    take = take_of(film, options("a.mp4", start_s=0.5, end_s=1.5, speed=1.0, fps=50.0))
    assert take.rows == tuple(range(25, 76))
    assert (take.width, take.height, take.fps) == (854, 480, 50.0)


def test_a_gif_is_small_unless_told_otherwise(film: Film) -> None:
    take = take_of(film, options("a.gif"))
    assert (take.width, take.height, take.fps, take.gif) == (480, 270, 12.5, True)
    assert take_of(film, options("a.gif", width=64, height=36, fps=10.0)).width == 64


def test_times_outside_the_episode_are_refused_with_those_inside(film: Film) -> None:
    with pytest.raises(ConfigError, match=r"from 0\.00 to \d+\.\d\d s, for --start, got 1000"):
        take_of(film, options("a.mp4", start_s=1000.0))


@pytest.mark.skipif(working_backend() is None, reason="no OpenGL library for off-screen rendering")
def test_an_mp4_has_the_frames_size_and_duration_asked_for(recorded: Path, tmp_path: Path) -> None:
    words = "--start 0.2 --end 2.2 --speed 2 --fps 25 --width 128 --height 72 --camera top"
    done = export(recorded, "--out", tmp_path / "a.mp4", *words.split())
    assert done.returncode == 0, done.stderr
    assert "128 x 72, 26 frames, 1.0 s" in done.stdout
    frames = imageio_ffmpeg.read_frames(str(tmp_path / "a.mp4"))
    facts = next(frames)
    pictures = np.array([np.frombuffer(frame, np.uint8) for frame in frames], dtype=np.float64)
    assert facts["size"] == (128, 72)
    assert facts["fps"] == 25.0
    assert facts["duration"] == pytest.approx(26 / 25, abs=0.02)
    assert len(pictures) == 26
    assert pictures.std(axis=1).min() > 10.0
    assert np.abs(np.diff(pictures, axis=0)).mean(axis=1).max() > 0.2
    assert [path.name for path in tmp_path.iterdir()] == ["a.mp4"]


@pytest.mark.skipif(working_backend() is None, reason="no OpenGL library for off-screen rendering")
def test_a_gif_moves_at_its_speed_and_repeats(recorded: Path, tmp_path: Path) -> None:
    words = "--to gif --end 1.99 --speed 2 --width 96 --height 54 --episode 1"
    done = export(recorded, "--out", tmp_path / "a.gif", *words.split())
    assert done.returncode == 0, done.stderr
    with Image.open(tmp_path / "a.gif") as gif:
        assert (gif.size, gif.n_frames, gif.info["loop"]) == ((96, 54), 13, 0)  # type: ignore[attr-defined]
        pauses = []
        for frame in range(13):
            gif.seek(frame)
            pauses.append(gif.info["duration"])
    assert set(pauses) == {80}
    assert [path.name for path in tmp_path.iterdir()] == ["a.gif"]


@pytest.mark.skipif(working_backend() is None, reason="no OpenGL library for off-screen rendering")
def test_an_interrupted_film_goes_on_to_the_film_of_an_undisturbed_one(
    film: Film, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    backend = working_backend()
    assert backend is not None
    for name, value in backend.environment(os.environ).items():
        monkeypatch.setenv(name, value)
    monkeypatch.setattr(rendering, "SEGMENT_FRAMES", 2)
    take = take_of(film, options("a.mp4", start_s=0.2, end_s=1.2, speed=2.0, fps=12.5, width=64, height=36))
    n_pieces, kept = -(-len(take.rows) // 2), tmp_path / "a.mp4.unfinished"
    done: list[int] = []

    def interrupted(n_done: int, n_all: int) -> None:
        done.append(n_done)
        if len(done) == 1:
            raise KeyboardInterrupt

    with pytest.raises(StopRequestedError, match=rf"interrupted: \d of {n_pieces} pieces are kept in {kept}; the same"):
        rendering.render(film, take, tmp_path / "a.mp4", interrupted, unfinished=kept)
    n_kept = len(list(kept.glob("*/[0-9]*.mp4")))
    assert 0 < n_kept <= n_pieces
    assert list(kept.glob("*/part-*")) == []
    told: list[tuple[int, int]] = []
    rendering.render(film, take, tmp_path / "a.mp4", lambda *pieces: told.append(pieces), unfinished=kept)
    assert told == [(n, n_pieces) for n in range(n_kept + 1, n_pieces + 1)]
    rendering.render(film, take, tmp_path / "whole.mp4", lambda *_: None)
    assert (tmp_path / "a.mp4").read_bytes() == (tmp_path / "whole.mp4").read_bytes()
    assert {path.name for path in tmp_path.iterdir()} == {"a.mp4", "whole.mp4"}
