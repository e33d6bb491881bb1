"""Options of `legpush export` and `legpush render`."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, get_args

from legpush.arguments import USUAL_OUTPUT, Flag, OutputOptions, Positional, Switch, arg
from legpush.bounds import Count, FramesPerSecond, Speed, TimeS
from legpush.errors import ConfigError
from legpush.fields import require
from legpush.options.checks import require_new_file
from legpush.options.formats import ENDINGS, FASTEST_GIF_FPS, FILMS, LARGEST_FRAME, Format, View
from legpush.options.recordings import Files


@dataclass(frozen=True, kw_only=True)
class ExportOptions:
    """Export a recording for other programs: a file for Foxglove, a table, a film, a page, or its robot as URDF.

    Exit codes: 0 exported, 2 bad input, 3 a program or library failed, 4 nothing can be drawn here, 130 interrupted.
    The recording is not changed, no existing file is overwritten, and the new file gets its name only when it is whole.
    """

    files: Files
    """The recording, or its parts."""
    to: Annotated[Format | None, arg("foxglove|csv|parquet|mp4|gif|urdf|html")] = None
    """Format of the new file; without it, the ending of --out decides (foxglove: .mcap)."""
    out: Annotated[Path | None, arg("FILE")] = None
    """The new file. If not given, it is beside the recording and named after it."""
    episode: Annotated[int | None, arg("N")] = None
    """Episode to export, as numbered by `legpush info`. If not given, tables have all episodes, with a column
    `episode`, and the other formats have the longest one."""
    partial: Flag = False
    """Export an incomplete episode up to its first gap or damage, instead of refusing it."""
    camera: Annotated[View, arg("|".join(get_args(View)))] = "follow"
    """Films: position of the camera. `follow`: right of the robot, a little behind; `top`: above the robot; `room`:
    above, with the whole room in view; `box`: close to the box; `orbit`: circling the robot."""
    speed: Annotated[float | None, arg("X")] = None
    """Films: simulated seconds per second. The default is 3, or more if the film would be longer than 30 s."""
    fps: Annotated[float | None, arg("N")] = None
    """Films: frames per second; 20 if not given, and 12.5 for a GIF."""
    width: Annotated[int | None, arg("PIXELS")] = None
    """Films: width of a frame; 854 if not given, and 480 for a GIF."""
    height: Annotated[int | None, arg("PIXELS")] = None
    """Films: height of a frame; 480 if not given, and 270 for a GIF."""
    caption: Switch = True
    """Films: write time, phase, error of the box and speeds into the picture."""
    start_s: Annotated[float, arg("S", name="start")] = 0.0
    """Films: begin at this simulated time."""
    end_s: Annotated[float | None, arg("S", name="end")] = None
    """Films: end at this simulated time."""
    output: OutputOptions = USUAL_OUTPUT

    def __post_init__(self) -> None:
        if not self.files:
            raise ConfigError("Expected the file of a recording, got none")
        made = self.format()
        require(Count, self.episode, "--episode, which `legpush info` lists")
        self._check_film(made)
        if self.out is not None or self.target().parent.is_dir():
            require_new_file(self.target(), "--out")

    def format(self) -> Format:
        """Return the format to make, from --to, the ending of --out, or both.

        Raises:
            ConfigError: Both are missing, or they contradict each other.
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
        """Return the path of the new file."""
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
            "no-caption": None if self.caption else True,
            "start": self.start_s or None,
            "end": self.end_s,
        }
        if made not in FILMS:
            for flag, value in given.items():
                if value is not None:
                    raise ConfigError(f"Expected --{flag} only with {' and '.join(FILMS)}, got it with {made}")
        require(Speed, self.speed, "--speed")
        require(FramesPerSecond, self.fps, "--fps")
        if made == "gif" and self.fps is not None and self.fps > FASTEST_GIF_FPS:
            raise ConfigError(f"Expected at most {FASTEST_GIF_FPS:g} for --fps of a GIF, got {self.fps}")
        for flag, pixels, most in (("width", self.width, LARGEST_FRAME[0]), ("height", self.height, LARGEST_FRAME[1])):
            if pixels is not None and not (16 <= pixels <= most and pixels % 2 == 0):
                raise ConfigError(f"Expected an even number of pixels from 16 to {most} for --{flag}, got {pixels}")
        require(TimeS, self.start_s, "--start")
        require(TimeS, self.end_s, "--end")
        if self.end_s is not None and not self.end_s > self.start_s:
            raise ConfigError(f"Expected more than --start, {self.start_s:g}, for --end, got {self.end_s}")


@dataclass(frozen=True, kw_only=True)
class RenderOptions:
    """Film a run again from its journal: write mission.mp4 into its folder."""

    run_folder: Positional[Annotated[Path, arg("DIR")]]
    """The folder of the run."""
    camera: Annotated[View, arg("|".join(get_args(View)))] = "follow"
    """Position of the camera; `legpush export --help` describes each."""
    caption: Switch = True
    """Write time, phase, error of the box and speeds into the picture."""
    output: OutputOptions = USUAL_OUTPUT
