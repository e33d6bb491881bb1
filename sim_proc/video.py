"""`python -m sim_proc.video FOLDER`: the recorded episode of a run as `mission.mp4`, rendered off screen.

The frames are rendered in parallel, in segments that ffmpeg joins without coding them again. Exit code 4 means that no
OpenGL library for off-screen rendering is present; then nothing is written.
"""

import multiprocessing
import os
import subprocess
import sys
import tempfile
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass
from math import ceil
from pathlib import Path
from typing import Annotated, Final

import imageio_ffmpeg
import tyro

from legpush.episode import read_episode
from legpush.errors import ConfigError, LegpushError
from legpush.robot import CONTROL_PERIOD_S
from sim_proc.film import Film, film_of

BACKENDS: Final = ("egl", "osmesa")
DRAW_NOTHING: Final = "import mujoco; mujoco.Renderer(mujoco.MjModel.from_xml_string('<mujoco/>'), 8, 8).render()"
NO_OPENGL: Final = 4
SEGMENT_FRAMES: Final = 60
LONGEST_S: Final = 30.0
LEAST_SPEED: Final = 3.0
"""Unless a speed is asked for: three times real time, or faster where the video would be longer than `LONGEST_S`."""


@dataclass(frozen=True, kw_only=True)
class VideoConfig:
    """Film the recorded episode of a run."""

    folder: tyro.conf.Positional[Path]
    """Folder that `legpush run` left."""
    speed: Annotated[float | None, tyro.conf.arg(metavar="X")] = None
    """Simulated seconds per second of video; by default 3, or more for a long mission."""
    fps: int = 20
    """Frames per second of video."""
    width: int = 854
    height: int = 480
    """Pixels of a frame."""


def main() -> None:
    """Film; one line on stderr if it cannot be done."""
    config = tyro.cli(VideoConfig)
    try:
        code = film_run(config)
    except LegpushError as error:
        sys.stderr.write(f"error: {error}\n")
        code = error.exit_code
    sys.exit(code)


def film_run(config: VideoConfig) -> int:
    """Write `mission.mp4` into the folder; the exit code."""
    journals = sorted(config.folder.glob("episode-*.journal"))
    if not journals:
        raise ConfigError(f"Expected the folder of a run, with an episode-*.journal in it, got {config.folder}")
    film = film_of(read_episode(journals[-1]), str(journals[-1]))
    backend = working_backend()
    if backend is None:
        sys.stderr.write(
            "No OpenGL library for off-screen rendering was found, so there is no video. "
            "Install one (Debian: libegl1 and libgl1-mesa-dri, or libosmesa6) and run `legpush render` on the folder.\n"
        )
        return NO_OPENGL
    os.environ.update(MUJOCO_GL=backend, LP_NUM_THREADS="1")  # one thread per worker for Mesa's software renderer
    speed = config.speed or max(LEAST_SPEED, film.duration_s / LONGEST_S)
    stride = max(1, round(speed / (config.fps * CONTROL_PERIOD_S)))
    ticks = list(range(0, len(film.qpos), stride))
    with tempfile.TemporaryDirectory(prefix="legpush-video-") as scratch:
        segments = _render_segments(film, config, ticks, Path(scratch))
        _join(segments, config.folder / "mission.mp4")
    return 0


def working_backend() -> str | None:
    """The first OpenGL backend that draws, tried in a process of its own; `MUJOCO_GL` decides if set."""
    asked = os.environ.get("MUJOCO_GL")
    for backend in (asked,) if asked else BACKENDS:
        attempt = subprocess.run(
            [sys.executable, "-c", DRAW_NOTHING],
            env={**os.environ, "MUJOCO_GL": backend},
            capture_output=True,
            check=False,
        )
        if attempt.returncode == 0:
            return backend
    return None


def _render_segments(film: Film, config: VideoConfig, ticks: list[int], scratch: Path) -> list[Path]:
    n_segments = ceil(len(ticks) / SEGMENT_FRAMES)
    jobs = [
        (scratch / f"{index:05d}.mp4", ticks[index * SEGMENT_FRAMES : (index + 1) * SEGMENT_FRAMES])
        for index in range(n_segments)
    ]
    workers = min(len(os.sched_getaffinity(0)), n_segments)
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(workers, context, initializer=_open_camera, initargs=(film, config)) as pool:
        done = as_completed([pool.submit(_render_segment, job) for job in jobs])
        for n_done, segment in enumerate(done, start=1):
            segment.result()
            sys.stdout.write(f"{n_done} of {n_segments} segments rendered\n")
            sys.stdout.flush()
    return [path for path, _ in jobs]


_worker: dict[str, object] = {}
"""Of a render worker: its camera and configuration, opened once."""


def _open_camera(film: Film, config: VideoConfig) -> None:
    from sim_proc.camera import Camera, FrameSize

    _worker["camera"] = Camera(film, FrameSize(width=config.width, height=config.height))
    _worker["config"] = config


def _render_segment(job: tuple[Path, list[int]]) -> None:
    from sim_proc.camera import Camera

    path, ticks = job
    camera, config = _worker["camera"], _worker["config"]
    if not isinstance(camera, Camera) or not isinstance(config, VideoConfig):
        raise TypeError("The worker was not opened")
    writer = imageio_ffmpeg.write_frames(
        str(path),
        (config.width, config.height),
        fps=config.fps,
        codec="libx264",
        macro_block_size=2,
        output_params=["-crf", "24", "-preset", "veryfast", "-threads", "1"],
    )
    writer.send(None)
    for tick in ticks:
        writer.send(camera.frame(tick).tobytes())
    writer.close()


def _join(segments: list[Path], target: Path) -> None:
    listing = segments[0].with_name("segments.txt")
    listing.write_text("".join(f"file '{segment}'\n" for segment in segments))
    command = [imageio_ffmpeg.get_ffmpeg_exe(), "-y", "-loglevel", "error", "-f", "concat", "-safe", "0"]
    joined = subprocess.run(
        [*command, "-i", str(listing), "-c", "copy", "-movflags", "+faststart", str(target)],
        capture_output=True,
        text=True,
        check=False,
    )
    if joined.returncode != 0:
        raise LegpushError(f"ffmpeg could not write {target}: {joined.stderr.strip()}")


if __name__ == "__main__":
    main()
