"""Writes films as files: renders frames in parallel, in segments that ffmpeg joins."""

import errno
import multiprocessing
import os
import subprocess
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass
from math import ceil
from multiprocessing.synchronize import Event
from pathlib import Path
from typing import Final

import imageio_ffmpeg
import numpy as np

from legpush.entry.interrupts import deaf_children
from legpush.errors import DiskFullError, LegpushError
from legpush.options.formats import View
from legpush.runs.temporary import temporary_folder
from legpush.scene.robot import CONTROL_PERIOD_S
from sim_proc.render.film import Film

SEGMENT_FRAMES: Final = 60
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


def frame_rows(n_rows: int, speed: float, fps: float) -> tuple[int, ...]:
    """The row to show in each frame, out of `n_rows`: the last one reached when the frame is due."""
    stride = speed / (fps * CONTROL_PERIOD_S)
    rows = np.floor(np.arange(ceil(n_rows / stride)) * stride + 1e-9).astype(int)
    return tuple(rows[rows < n_rows].tolist())


def usual_speed(duration_s: float) -> float:
    """The speed to use if none is asked for, in simulated seconds per second of film."""
    return max(LEAST_SPEED, duration_s / LONGEST_S)


def render(film: Film, take: Take, target: Path, say: Callable[[int, int], None]) -> None:
    """Write a film to a file, which is replaced; call `say` with the numbers of finished and of all segments.

    Raises:
        LegpushError: ffmpeg failed.
    """
    with temporary_folder("video-") as scratch:
        listing = _render_segments(film, take, scratch, say)
        if take.gif:
            _join_as_gif(listing, target.absolute())
        else:
            _ffmpeg(listing, "-c", "copy", "-movflags", "+faststart", str(target.absolute()))


def _render_segments(film: Film, take: Take, scratch: Path, say: Callable[[int, int], None]) -> Path:
    """Render all segments and return the file that lists them."""
    n_segments = ceil(len(take.rows) / SEGMENT_FRAMES)
    jobs = [
        (scratch / f"{index:05d}.mp4", take.rows[index * SEGMENT_FRAMES : (index + 1) * SEGMENT_FRAMES])
        for index in range(n_segments)
    ]
    context = multiprocessing.get_context("spawn")
    stop = context.Event()
    workers = min(len(os.sched_getaffinity(0)), n_segments)
    with ProcessPoolExecutor(workers, context, initializer=_open_camera, initargs=(film, take, stop)) as pool:
        try:
            with deaf_children():
                segments = [pool.submit(_render_segment, job) for job in jobs]
            for n_done, segment in enumerate(as_completed(segments), start=1):
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

    _worker.update(
        camera=Camera(film, FrameSize(width=take.width, height=take.height), take.view), take=take, stop=stop
    )


def _render_segment(job: tuple[Path, tuple[int, ...]]) -> None:
    """Render the rows of a segment to its file, in a render worker."""
    from sim_proc.render.camera import Camera

    path, rows = job
    camera, take, stop = _worker["camera"], _worker["take"], _worker["stop"]
    if not isinstance(camera, Camera) or not isinstance(take, Take) or not isinstance(stop, Event):
        raise TypeError("The render worker was not set up")
    if stop.is_set():
        return
    writer = imageio_ffmpeg.write_frames(
        str(path),
        (take.width, take.height),
        fps=take.fps,
        codec="libx264rgb" if take.gif else "libx264",
        pix_fmt_out="rgb24" if take.gif else "yuv420p",
        macro_block_size=2,
        quality=None,
        ffmpeg_log_level="error",
        output_params=list(LOSSLESS if take.gif else SMALL),
    )
    writer.send(None)
    for row in rows:
        writer.send(camera.frame(row).tobytes())
        if stop.is_set():  # only after a frame: ffmpeg complains about a film without frames
            break
    writer.close()


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
