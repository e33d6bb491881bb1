"""Maps as a program: `legpush map FILE`."""

import sys
from pathlib import Path

from agent_proc.reporting.map_picture import is_own_picture, save_map_picture
from agent_proc.reporting.map_view import read_view
from legpush.errors import ConfigError, one_line
from legpush.options.checks import require_writable_file
from legpush.options.maps import MapOptions
from legpush.output.reply import document
from legpush.service import run_command


def main() -> int:
    """Parse the command line and draw; returns the exit code."""
    return run_command("map", MapOptions, run)


def run(options: MapOptions) -> int:
    """Read the map, describe and draw it; returns the exit code.

    Raises:
        ConfigError: The picture cannot be written, or would overwrite another file.
    """
    picture = options.picture()
    require_writable_file(picture, "--out")
    _require_own(picture)
    view = read_view(options)
    try:
        save_map_picture(view, picture)
    except OSError as error:
        raise ConfigError(f"{picture}: expected a file that can be written ({error.strerror})") from error
    sys.stdout.write("".join(f"{one_line(line)}\n" for line in view.lines()))
    sys.stdout.write(f"wrote {picture}\n")
    document(
        {
            "picture": picture,
            "size_m": view.size_m,
            "cell_m": view.resolution_m,
            "origin_m": view.origin_m,
            "occupied_share": view.occupied.mean(),
            "n_rectangles": view.n_walls,
        }
    )
    return 0


def _require_own(picture: Path) -> None:
    """Require that the picture overwrites no file but one of this program."""
    try:
        if picture.exists() and not is_own_picture(picture):
            raise ConfigError(f"{picture}: expected a new file for --out, or a picture of `legpush map`")
    except OSError as error:
        raise ConfigError(f"{picture}: expected a file for --out ({error.strerror})") from error
