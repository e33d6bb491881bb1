"""Options of `legpush export`."""

from dataclasses import dataclass
from math import isfinite
from pathlib import Path
from typing import Annotated, get_args

import tyro

from legpush.errors import ConfigError
from legpush.exports import ENDINGS, FASTEST_GIF_FPS, FILMS, LARGEST_FRAME, Format, View
from legpush.options.checks import require_new_file, require_not_negative, require_positive
from legpush.options.recordings import Files


@dataclass(frozen=True, kw_only=True)
class ExportOptions:
    """Export a recording for other programs: a file for Foxglove, a table of its time series, or a film.

    Exit codes: 0 exported, 2 bad input, 3 a program or library failed, 4 nothing can be drawn here, 130 interrupted.
    The recording stays as it is, a file that exists is kept, and what is not whole never gets the name asked for.
    """

    files: Files
    """The recording, or its parts."""
    to: Annotated[Format | None, tyro.conf.arg(metavar="foxglove|csv|parquet|mp4|gif")] = None
    """What to make; told by the ending of --out as well (foxglove: .mcap)."""
    out: Annotated[Path | None, tyro.conf.arg(metavar="FILE")] = None
    """The new file; if not given, beside the recording and named after it."""
    episode: Annotated[int | None, tyro.conf.arg(metavar="N")] = None
    """Which one, as `legpush info` counts them. Else tables have all episodes, in the column `episode`, and what shows
    one has the longest."""
    partial: bool = False
    """Take what comes before the first gap or damage of an episode, instead of refusing it."""
    camera: Annotated[View, tyro.conf.arg(metavar="|".join(get_args(View)))] = "follow"
    """Films: where it is seen from. `follow`: from the right, a little behind; `top`: from above the robot; `room`: all
    of it from above; `box`: close to the box; `orbit`: around the robot."""
    speed: Annotated[float | None, tyro.conf.arg(metavar="X")] = None
    """Films: simulated seconds per second; by default 3, or more where it would take longer than 30 s."""
    fps: Annotated[float | None, tyro.conf.arg(metavar="N")] = None
    """Films: frames per second, 20 if not given, 12.5 of a GIF."""
    width: Annotated[int | None, tyro.conf.arg(metavar="PIXELS")] = None
    """Films: 854 if not given, 480 of a GIF."""
    height: Annotated[int | None, tyro.conf.arg(metavar="PIXELS")] = None
    """Films: 480 if not given, 270 of a GIF."""
    start_s: Annotated[float, tyro.conf.arg(name="start", metavar="S")] = 0.0
    """Films: from this simulated time on."""
    end_s: Annotated[float | None, tyro.conf.arg(name="end", metavar="S")] = None
    """Films: up to this simulated time."""

    def __post_init__(self) -> None:
        if not self.files:
            raise ConfigError("Expected the file of a recording, got none")
        made = self.format()
        if self.episode is not None and self.episode < 0:
            raise ConfigError(f"Expected 0 or more for --episode, got {self.episode}; `legpush info` lists them")
        self._check_film(made)
        if self.out is not None or self.target().parent.is_dir():
            require_new_file(self.target(), "--out")

    def format(self) -> Format:
        """Return the format to make, from --to, the ending of --out, or both.

        Raises:
            ConfigError: Neither says it, or they contradict each other.
        """
        if self.out is None:
            if self.to is None:
                raise ConfigError(
                    f"Expected --to with one of {', '.join(ENDINGS)}, or --out with its ending, got neither"
                )
            return self.to
        told = next((name for name, ending in ENDINGS.items() if self.out.suffix.lower() == ending), None)
        if told is None or self.to not in (None, told):
            endings = [ENDINGS[self.to]] if self.to is not None else list(ENDINGS.values())
            raise ConfigError(f"Expected a file that ends in {' or '.join(endings)} for --out, got {self.out}")
        return told

    def target(self) -> Path:
        """The new file."""
        if self.out is not None:
            return self.out
        made, first = self.format(), self.files[0]
        words = [first.stem]
        if self.episode is not None:
            words += [f"episode-{self.episode}"]
        if made in FILMS and self.camera != "follow":
            words += [self.camera]
        if made == "foxglove":
            words += ["foxglove"]
        return first.with_name("-".join(words) + ENDINGS[made])

    def _check_film(self, made: Format) -> None:
        given = {
            "camera": None if self.camera == "follow" else self.camera,
            "speed": self.speed,
            "fps": self.fps,
            "width": self.width,
            "height": self.height,
            "start": self.start_s or None,
            "end": self.end_s,
        }
        if made not in FILMS:
            for flag, value in given.items():
                if value is not None:
                    raise ConfigError(f"Expected --{flag} only with {' and '.join(FILMS)}, got it with {made}")
        require_positive(self.speed, "--speed")
        require_positive(self.fps, "--fps")
        if made == "gif" and self.fps is not None and self.fps > FASTEST_GIF_FPS:
            raise ConfigError(f"Expected at most {FASTEST_GIF_FPS:g} for --fps of a GIF, got {self.fps}")
        for flag, pixels, most in (("width", self.width, LARGEST_FRAME[0]), ("height", self.height, LARGEST_FRAME[1])):
            if pixels is not None and not (16 <= pixels <= most and pixels % 2 == 0):
                raise ConfigError(f"Expected an even number of pixels from 16 to {most} for --{flag}, got {pixels}")
        require_not_negative(self.start_s, "--start")
        if self.end_s is not None and not (isfinite(self.end_s) and self.end_s > self.start_s):
            raise ConfigError(f"Expected more than --start, {self.start_s:g}, for --end, got {self.end_s}")
