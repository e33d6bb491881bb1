"""Writes films as files: renders frames in parallel, in segments that ffmpeg joins."""

import errno
import multiprocessing
import os
import shutil
import subprocess
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass
from hashlib import sha256
from importlib.metadata import version
from math import ceil
from multiprocessing.synchronize import Event
from pathlib import Path
from typing import Final

import imageio_ffmpeg
import msgspec
import numpy as np

from legpush.entry.interrupts import deaf_children
from legpush.errors import DiskFullError, LegpushError, StopRequestedError
from legpush.options.formats import View
from legpush.runs.temporary import temporary_folder
from legpush.scene.conventions import CONTROL_PERIOD_S
from sim_proc.render.film import Film

SEGMENT_FRAMES: Final = 60
DRAWN_LARGER: Final = 1.5
"""A frame is drawn this many times as wide and high as it is shown."""
SEGMENTS: Final = "[0-9]*.mp4"
"""Names of finished segments."""
LONGEST_S: Final = 30.0
LEAST_SPEED: Final = 3.0
"""The usual speed is three times real time, or faster if the film would last longer than `LONGEST_S`."""
SMALL: Final = ("-crf", "24", "-preset", "veryfast", "-threads", "1")
LOSSLESS: Final = ("-qp", "0", "-preset", "ultrafast", "-threads", "1")
"""Options of ffmpeg for the segments of an MP4 film, and of a GIF film."""


@dataclass(frozen=True, kw_only=True)
class Take:
    """The frames of a film to render, and their size and format."""

    rows: tuple[int, ...]
    """A row of the film for each frame."""
    fps: float
    width: int
    height: int
    view: View = "follow"
    gif: bool = False
    """Whether to write a GIF file instead of an MP4 file with H.264."""
    speed: float | None = None
    """The times real time for the captions of the frames; None for frames without one."""

    @property
    def drawn(self) -> tuple[int, int]:
        """Width and height of a frame as it is drawn, before ffmpeg scales it down: that smooths its edges."""
        return 2 * round(DRAWN_LARGER * self.width / 2), 2 * round(DRAWN_LARGER * self.height / 2)


def frame_rows(n_rows: int, speed: float, fps: float) -> tuple[int, ...]:
    """The row to show in each frame, out of `n_rows`: the last one reached when the frame is due."""
    stride = speed / (fps * CONTROL_PERIOD_S)
    rows = np.floor(np.arange(ceil(n_rows / stride)) * stride + 1e-9).astype(int)
    return tuple(rows[rows < n_rows].tolist())


def usual_speed(duration_s: float) -> float:
    """The speed to use if none is asked for, in simulated seconds per second of film."""
    return max(LEAST_SPEED, duration_s / LONGEST_S)


def render(
    film: Film, take: Take, target: Path, say: Callable[[int, int], None], *, unfinished: Path | None = None
) -> None:
    """Write a film to a file, which is replaced; call `say` with the numbers of finished and of all segments.

    With `unfinished`, finished segments are kept in that folder until the film is whole: the same film goes on there.

    Raises:
        StopRequestedError: The user interrupted it, and finished segments are kept.
        LegpushError: ffmpeg failed.
    """
    if unfinished is None:
        with temporary_folder("video-") as scratch:
            _render_into(film, take, target, scratch, say)
        return
    own, whole = unfinished / _identity(film, take), False
    try:
        own.mkdir(parents=True, exist_ok=True)
        for other in set(unfinished.iterdir()) - {own}:
            shutil.rmtree(other)
        _render_into(film, take, target, own, say)
        whole = True
    except KeyboardInterrupt as interrupt:
        n_kept = len(list(own.glob(SEGMENTS)))
        if not n_kept:
            raise
        raise StopRequestedError(
            f"interrupted: {n_kept} of {_n_segments(take)} pieces are kept in {unfinished}; the same command goes on"
        ) from interrupt
    finally:
        if whole or not list(own.glob(SEGMENTS)):
            shutil.rmtree(unfinished, ignore_errors=True)


def _render_into(film: Film, take: Take, target: Path, folder: Path, say: Callable[[int, int], None]) -> None:
    listing = _render_segments(film, take, folder, say)
    if take.gif:
        _join_as_gif(listing, target.absolute())
    else:
        _ffmpeg(listing, "-c", "copy", "-movflags", "+faststart", str(target.absolute()))


def _identity(film: Film, take: Take) -> str:
    """Sixteen hexadecimal digits that are equal for equal films of equal versions."""
    digest = sha256(msgspec.json.encode(film.scenario))
    digest.update(film.qpos.tobytes())
    digest.update(repr((take, film.first_tick, version("legpush"), version("mujoco"))).encode())
    return digest.hexdigest()[:16]


def _n_segments(take: Take) -> int:
    return ceil(len(take.rows) / SEGMENT_FRAMES)


def _render_segments(film: Film, take: Take, scratch: Path, say: Callable[[int, int], None]) -> Path:
    """Render the segments that are not there, and return the file that lists all of them."""
    n_segments = _n_segments(take)
    jobs = [
        (scratch / f"{index:05d}.mp4", take.rows[index * SEGMENT_FRAMES : (index + 1) * SEGMENT_FRAMES])
        for index in range(n_segments)
    ]
    context = multiprocessing.get_context("spawn")
    stop = context.Event()
    missing = [job for job in jobs if not job[0].exists()]
    n_before = n_segments - len(missing)
    workers = max(1, min(len(os.sched_getaffinity(0)), len(missing)))
    with ProcessPoolExecutor(workers, context, initializer=_open_camera, initargs=(film, take, stop)) as pool:
        try:
            with deaf_children():
                segments = [pool.submit(_render_segment, job) for job in missing]
            for n_done, segment in enumerate(as_completed(segments), start=n_before + 1):
                segment.result()
                say(n_done, n_segments)
        except BaseException:
            stop.set()
            pool.shutdown(wait=True, cancel_futures=True)
            raise
    listing = scratch / "segments.txt"
    listing.write_text("".join(f"file '{path.name}'\n" for path, _ in jobs))
    return listing


_worker: dict[str, object] = {}
"""State of a render worker: its camera, its take and the event that stops it."""


def _open_camera(film: Film, take: Take, stop: Event) -> None:
    """Set up a render worker."""
    from sim_proc.render.camera import Camera, FrameSize

    width, height = take.drawn
    camera = Camera(film, FrameSize(width=width, height=height), take.view, take.speed)
    _worker.update(camera=camera, take=take, stop=stop)


def _render_segment(job: tuple[Path, tuple[int, ...]]) -> None:
    """Render the rows of a segment to its file, which is whole or absent, in a render worker."""
    from sim_proc.render.camera import Camera

    path, rows = job
    camera, take, stop = _worker["camera"], _worker["take"], _worker["stop"]
    if not isinstance(camera, Camera) or not isinstance(take, Take) or not isinstance(stop, Event):
        raise TypeError("The render worker was not set up")
    if stop.is_set():
        return
    part = path.with_name(f"part-{path.name}")
    writer = imageio_ffmpeg.write_frames(
        str(part),
        take.drawn,
        fps=take.fps,
        codec="libx264rgb" if take.gif else "libx264",
        pix_fmt_out="rgb24" if take.gif else "yuv420p",
        macro_block_size=2,
        quality=None,
        ffmpeg_log_level="error",
        output_params=[
            *(LOSSLESS if take.gif else SMALL),
            *("-vf", f"scale={take.width}:{take.height}:flags=bilinear"),
        ],
    )
    writer.send(None)
    for row in rows:
        writer.send(camera.frame(row).tobytes())
        if stop.is_set():  # only after a frame: ffmpeg complains about a film without frames
            break
    writer.close()
    if stop.is_set():
        part.unlink(missing_ok=True)
    else:
        part.replace(path)


def _join_as_gif(listing: Path, target: Path) -> None:
    """Join segments in two passes: find the best 256 colors of all frames, then convert the frames to them."""
    palette = "palette.png"
    _ffmpeg(listing, "-vf", "palettegen=stats_mode=diff", palette)
    colors = "paletteuse=dither=bayer:bayer_scale=4:diff_mode=rectangle"
    _ffmpeg(listing, "-i", palette, "-lavfi", colors, "-loop", "0", str(target))


def _ffmpeg(listing: Path, *arguments: str) -> None:
    """Run ffmpeg on the listed segments as one film. The last argument is the file that it writes.

    It works in the folder of the segments: with bare names, no character of a path means something to ffmpeg.

    Raises:
        DiskFullError: There is no space for the file.
        LegpushError: ffmpeg failed otherwise; with its message.
    """
    segments = ("-f", "concat", "-safe", "0", "-i", listing.name)
    command = [imageio_ffmpeg.get_ffmpeg_exe(), "-y", "-nostdin", "-loglevel", "error", *segments, *arguments]
    done = subprocess.run(command, cwd=listing.parent, capture_output=True, text=True, errors="replace", check=False)
    if done.returncode != 0:
        why = done.stderr.strip() or f"it ended with {done.returncode}"
        kind = DiskFullError if os.strerror(errno.ENOSPC) in why else LegpushError
        raise kind(f"ffmpeg could not write {Path(arguments[-1]).name}: {why}")
