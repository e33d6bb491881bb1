"""The video of a recorded episode, rendered for real where the machine can."""

import os
import subprocess
import sys
from pathlib import Path

import imageio_ffmpeg
import numpy as np
import pytest
from msgspec.structs import replace

from legpush.errors import NO_OPENGL, JournalError, RecordingError
from legpush.geometry import Pose2
from legpush.history.entries import Acted, Observed, Opened
from legpush.history.journal import Journal
from legpush.history.steps import StepRecord, read_episode
from legpush.messages.stepping import Follow, Motion, Push, Reset, Walk
from legpush.scene.scenario import Rectangle, Room, Scenario
from sim_proc.render.backends import working_backend
from sim_proc.render.film import Film, film_of, timeline_of
from sim_proc.simulator import Simulator


@pytest.fixture
def run_folder(at_the_box: Scenario, tmp_path: Path) -> Path:
    """A run that was recorded: a push, then a step back."""
    motions: list[Motion] = [
        Reset(scenario=at_the_box, seed=0),
        Push(w1=0.5, w2=0.5, leg="FL", depth_m=0.05),
        Follow(waypoints=(Pose2(x_m=2.0, y_m=5.0, yaw_rad=0.0), Pose2(x_m=1.8, y_m=5.0, yaw_rad=0.0))),
        Walk(),
    ]
    simulator = Simulator()
    opened = Opened(protocol=1, run="r", seed=0, versions={}, began_unix_s=0.0)
    with Journal(tmp_path / "episode-0000.journal", opened) as journal:
        for motion in motions:
            journal.append(Acted(motion=motion, with_trace=True))
            journal.append(Observed(outcome=simulator.perform(motion, with_trace=True)))
    return tmp_path


def film_of_journal(folder: Path) -> Film:
    return film_of(timeline_of(read_episode(folder / "episode-0000.journal"), "here"), "here")


def make_video(folder: Path, **environment: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "sim_proc.render", str(folder), "--width", "160", "--height", "90"]
    return subprocess.run(
        command, env={**os.environ, **environment}, capture_output=True, text=True, check=False, timeout=60
    )


def test_a_film_has_every_tick_the_followed_path_and_the_footprints(run_folder: Path) -> None:
    journal = run_folder / "episode-0000.journal"
    outcomes = [record.outcome for record in read_episode(journal)]  # type: ignore[union-attr]
    film = film_of_journal(run_folder)
    assert len(film.qpos) == outcomes[-1].world.tick + 1
    assert film.trunk_m.shape == (len(film.qpos), 2)
    assert np.abs(film.trunk_m - film.qpos[:, :2]).max() < 0.1
    pushed_ticks = outcomes[1].world.tick
    assert [since for since, _ in film.paths_m] == [pushed_ticks + 1]
    n_steps = outcomes[-1].world.n_footsteps
    assert n_steps == 8
    assert n_steps <= len(film.footprints) <= n_steps + 4


def test_a_film_hides_an_obstacle_until_the_tick_at_which_it_appeared(at_the_box: Scenario) -> None:
    def wall(x_m: float, appears_at_s: float) -> Rectangle:
        return Rectangle(x_min_m=x_m, x_max_m=x_m + 0.5, y_min_m=8.0, y_max_m=9.0, appears_at_s=appears_at_s)

    walls = (wall(1.0, 0.0), wall(4.0, 0.4), wall(7.0, 1000.0))
    scenario = replace(at_the_box, room=Room(size_m=(12.0, 10.0), obstacles=walls))
    simulator = Simulator()
    motions: list[Motion] = [Reset(scenario=scenario, seed=0), Push(w1=0.5, w2=0.5, leg="FL", depth_m=0.05)]
    records = [StepRecord(motion, simulator.perform(motion, with_trace=True)) for motion in motions]

    film = film_of(timeline_of(records, "here"), "here")

    assert film.hidden_until == {1: 20, 2: None}


def test_an_episode_without_traces_cannot_be_filmed() -> None:
    with pytest.raises(JournalError, match="no-such-run: expected an episode recorded with traces"):
        timeline_of([], "no-such-run")


def test_ticks_without_a_trace_stand_still_and_an_episode_of_them_cannot_be_filmed(at_the_box: Scenario) -> None:
    def film(*traced: bool) -> Film:
        simulator = Simulator()
        push = Push(w1=0.5, w2=0.5, leg="FL", depth_m=0.05)
        motions: list[Motion] = [Reset(scenario=at_the_box, seed=0), push, push]
        with_traces = zip(motions, (True, *traced), strict=True)
        records = [StepRecord(motion, simulator.perform(motion, with_trace=each)) for motion, each in with_traces]
        return film_of(timeline_of(records, "here"), "here")

    whole, half = film(True, True), film(True, False)
    n_traced = len(film(True, True).qpos) // 2
    assert len(half.qpos) == len(whole.qpos)
    np.testing.assert_array_equal(half.qpos[:n_traced], whole.qpos[:n_traced])
    np.testing.assert_array_equal(half.qpos[-1], whole.qpos[-1])
    assert (half.qpos[-2] == half.qpos[-40]).all()
    with pytest.raises(RecordingError, match="here: expected an episode recorded with traces, got one without traces"):
        film(False, False)


def test_the_video_has_twenty_frames_for_each_of_its_seconds_or_says_why_there_is_none(
    run_folder: Path, tmp_path_factory: pytest.TempPathFactory
) -> None:
    strange = tmp_path_factory.mktemp("strange") / "a b's 100%d"
    strange.mkdir()
    done = make_video(run_folder, TMPDIR=str(strange), MUJOCO_GL="nonsense", PYOPENGL_PLATFORM="x11")
    video = run_folder / "mission.mp4"
    if working_backend() is None:
        assert done.returncode == NO_OPENGL
        assert "no OpenGL library" in done.stderr
        assert not video.exists()
        return
    assert done.returncode == 0, done.stderr
    frames = imageio_ffmpeg.read_frames(str(video))
    assert next(frames)["size"] == (160, 90)
    pictures = np.array([np.frombuffer(frame, np.uint8) for frame in frames], dtype=np.float64)
    duration_s = (len(film_of_journal(run_folder).qpos) - 1) * 0.02
    assert 20 * duration_s / 3 - 1 < len(pictures) <= 20 * duration_s / 3 + 1
    assert pictures.std(axis=1).min() > 10.0
    assert np.abs(np.diff(pictures, axis=0)).mean(axis=1).max() > 0.5


def test_without_a_working_opengl_library_a_notice_says_why_and_what_to_install(
    run_folder: Path, tmp_path_factory: pytest.TempPathFactory
) -> None:
    broken = tmp_path_factory.mktemp("broken")
    (broken / "OpenGL.py").write_text("raise ImportError('broken on purpose')")
    done = make_video(run_folder, PYTHONPATH=f"{broken}:{os.environ.get('PYTHONPATH', '')}", MUJOCO_GL="osmesa")
    assert done.returncode == NO_OPENGL
    assert "broken on purpose" in done.stderr
    assert "Set are MUJOCO_GL=osmesa" in done.stderr
    assert "libosmesa6" in done.stderr
    assert len(done.stderr.splitlines()) == 1
    assert not (run_folder / "mission.mp4").exists()


def test_a_folder_that_is_no_run_is_refused_in_one_line(tmp_path: Path) -> None:
    done = make_video(tmp_path)
    assert done.returncode == 2
    assert done.stderr.startswith("error: Expected the folder of a run")
    assert len(done.stderr.splitlines()) == 1


def test_a_film_knows_the_phase_at_each_row(run_folder: Path) -> None:
    film = film_of_journal(run_folder)
    assert [phase for _, phase in film.phases] == ["standing", "pushing", "walking"]
    rows = [row for row, _ in film.phases]
    assert rows == sorted(rows)
    assert rows[-1] < len(film.qpos)
