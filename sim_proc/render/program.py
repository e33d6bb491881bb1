"""The program that renders the recorded episode of a run off screen as `mission.mp4`.

Exit code 4 means that there is no OpenGL library for off-screen rendering. Then nothing is written.
"""

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from legpush.arguments import USUAL_OUTPUT, OutputOptions, Positional, arg
from legpush.errors import NO_OPENGL, ConfigError
from legpush.history.steps import read_episode
from legpush.options.formats import View
from legpush.output.reply import document
from legpush.runs.folder import require_no_links
from legpush.service import run_command
from sim_proc.render.backends import use_backend
from sim_proc.render.film import film_of, timeline_of
from sim_proc.render.rendering import Take, frame_rows, render, usual_speed


@dataclass(frozen=True, kw_only=True)
class VideoConfig:
    """Film the recorded episode of a run."""

    folder: Positional[Annotated[Path, arg("DIR")]]
    """Folder that `legpush run` wrote."""
    camera: Annotated[View, arg()] = "follow"
    """Where the film is seen from."""
    speed: Annotated[float | None, arg("X")] = None
    """Simulated seconds per second of video; by default 3, or more for a long mission."""
    fps: Annotated[float, arg("N")] = 20.0
    """Frames per second of video."""
    width: Annotated[int, arg("PIXELS")] = 854
    height: Annotated[int, arg("PIXELS")] = 480
    """Pixels of a frame."""
    output: OutputOptions = USUAL_OUTPUT


def main() -> int:
    """Film the run; write one line to stderr if that fails."""
    return run_command("render", VideoConfig, film_run)


def film_run(config: VideoConfig) -> int:
    """Write `mission.mp4` into the folder and return the exit code.

    Raises:
        ConfigError: The folder has no journal, or a link.
        JournalError: No episode begins in the journal.
        RecordingError: The episode has no traces.
        LegpushError: ffmpeg failed.
    """
    journals = sorted(config.folder.glob("episode-*.journal"))
    if not journals:
        raise ConfigError(f"Expected the folder of a run, with an episode-*.journal in it, got {config.folder}")
    require_no_links(config.folder)
    where = str(journals[-1])
    film = film_of(timeline_of(read_episode(journals[-1]), where), where)
    if not use_backend(f"legpush render {config.folder}"):
        return NO_OPENGL
    speed = config.speed or usual_speed(film.duration_s)
    take = Take(
        rows=frame_rows(len(film.qpos), speed, config.fps),
        fps=config.fps,
        width=config.width,
        height=config.height,
        view=config.camera,
    )
    target = config.folder / "mission.mp4"
    render(film, take, target, _say)
    document({"file": target, "n_frames": len(take.rows), "fps": take.fps, "speed": speed})
    return 0


def _say(n_done: int, n_segments: int) -> None:
    sys.stdout.write(f"{n_done} of {n_segments} segments rendered\n")
    sys.stdout.flush()
