"""Writes a recorded episode as a film."""

from collections.abc import Callable
from math import floor
from pathlib import Path
from typing import Final

from legpush.errors import ConfigError
from legpush.options.export import ExportOptions
from legpush.scene.conventions import CONTROL_PERIOD_S
from sim_proc.export.source import Exported
from sim_proc.render.film import Film, film_of
from sim_proc.render.rendering import Take, frame_rows, render, usual_speed

FILM_FPS: Final = 20.0
FILM_SIZE: Final = (854, 480)
GIF_FPS: Final = 12.5
GIF_SIZE: Final = (480, 270)


def film_episode(
    episode: Exported, options: ExportOptions, where: str, target: Path, say: Callable[[int, int], None]
) -> str:
    """Write the film and return a description of it in a few words.

    Until it is whole, finished pieces are kept beside the file that the options name.

    Raises:
        RecordingError: The episode has no traces.
        ConfigError: No time of the episode is between --start and --end.
        StopRequestedError: The user interrupted it, and finished pieces are kept.
        LegpushError: ffmpeg failed.
    """
    film = film_of(episode.timeline, f"{where}, episode {episode.index}")
    take = take_of(film, options)
    whole = options.target()
    render(film, take, target, say, unfinished=whole.with_name(f"{whole.name}.unfinished"))
    return f"{take.width} x {take.height}, {len(take.rows)} frames, {len(take.rows) / take.fps:.1f} s"


def take_of(film: Film, options: ExportOptions) -> Take:
    """Choose the frames to render.

    Raises:
        ConfigError: No time of the episode is between --start and --end.
    """
    gif = options.format() == "gif"
    fps = options.fps or (GIF_FPS if gif else FILM_FPS)
    width, height = GIF_SIZE if gif else FILM_SIZE
    first_s = film.first_tick * CONTROL_PERIOD_S
    last_s = first_s + film.duration_s
    if options.start_s > last_s or (options.end_s is not None and options.end_s < first_s):
        flag, got = ("start", options.start_s) if options.start_s > last_s else ("end", options.end_s)
        raise ConfigError(
            f"Expected a time of the episode, from {first_s:.2f} to {last_s:.2f} s, for --{flag}, got {got}"
        )
    begin = max(0, _row(options.start_s - first_s))
    end = len(film.qpos) if options.end_s is None else min(len(film.qpos), _row(options.end_s - first_s) + 1)
    speed = options.speed or usual_speed((end - begin) * CONTROL_PERIOD_S)
    return Take(
        rows=tuple(begin + row for row in frame_rows(end - begin, speed, fps)),
        fps=fps,
        width=options.width or width,
        height=options.height or height,
        view=options.camera,
        gif=gif,
        speed=speed if options.caption else None,
    )


def _row(time_s: float) -> int:
    """The last row at or before a time, which is counted from row 0."""
    return floor(time_s / CONTROL_PERIOD_S + 1e-6)
