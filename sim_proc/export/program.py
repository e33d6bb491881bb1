"""The program of `legpush export`: writes a recording as a file for another program."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path
from typing import Final

from rich.console import Console

from legpush.errors import ConfigError, one_line
from legpush.files import new_file, sha256_of
from legpush.long_work.progress import pieces
from legpush.options.export import ExportOptions
from legpush.options.formats import FILMS, Format
from legpush.output.reply import document
from legpush.service import run_command
from sim_proc.export.columns import columns_of
from sim_proc.export.source import Source, longest, notes, read_source
from sim_proc.export.table_csv import write_csv

LIBRARIES: Final[dict[Format, tuple[str, str]]] = {
    "foxglove": ("foxglove", "foxglove-sdk"),
    "parquet": ("pyarrow", "pyarrow"),
    "html": ("viser", "viser"),
}
"""Module and package of formats whose library may be missing."""


def main() -> int:
    """Parse the command line, export, and return the exit code."""
    return run_command("export", ExportOptions, export)


def export(options: ExportOptions) -> int:
    """Write the file, describe it on stdout, and return the exit code.

    Raises:
        LegpushError: The options, the recording or the file cannot be used, or ffmpeg failed.
    """
    made, target = options.format(), options.target()
    _require_library(made)
    source = read_source(options.files, options.episode, partial=options.partial)
    if made in FILMS:
        from legpush.errors import NO_OPENGL
        from sim_proc.render.backends import use_backend

        if not use_backend("legpush export"):
            return NO_OPENGL
    with whole_file(target) as scratch:
        what = _write(source, options, made, scratch)
    sys.stdout.write(f"wrote {target}: {what}\n")
    said = list(notes(source))
    document({"file": target, "format": made, "what": what, "notes": said})
    for note in said:
        sys.stderr.write(f"note: {one_line(note)}\n")
    return 0


@contextmanager
def whole_file(target: Path) -> Iterator[Path]:
    """Yield a path to write to, and move the file to `target` once it is whole. No other file is replaced.

    Raises:
        ConfigError: The file cannot be written, or `target` exists.
    """
    try:
        with new_file(target) as scratch:
            yield scratch
    except OSError as error:
        raise ConfigError(f"{target}: expected a new file that can be written ({error.strerror or error})") from error


def _write(source: Source, options: ExportOptions, made: Format, scratch: Path) -> str:
    """Write the file and return a description of it in a few words."""
    say = pieces(Console(stderr=True, quiet=options.output.quiet), "exporting")
    if made in ("csv", "parquet"):
        columns = columns_of(source.episodes)
        if made == "csv":
            write_csv(columns, scratch)
        else:
            from sim_proc.export.table_parquet import write_parquet

            write_parquet(columns, about(source), scratch)
        episodes = f"{len(source.episodes)} episode{'s' * (len(source.episodes) != 1)}"
        return f"{len(columns[0].values)} rows, {len(columns)} columns, {episodes}"
    episode = longest(source.episodes)
    if made == "urdf":
        from sim_proc.export.urdf import robot_urdf

        scratch.write_text(robot_urdf(episode.timeline.scenario), encoding="utf-8")
        return f"the robot of episode {episode.index}"
    if made == "html":
        from sim_proc.export.html_file import write_html

        return f"episode {episode.index}, {write_html(source.history, episode.timeline, scratch, say)}"
    if made == "foxglove":
        from sim_proc.export.foxglove_file import write_foxglove

        return f"episode {episode.index}, {write_foxglove(source, episode, about(source), scratch, say)}"
    from sim_proc.export.films import film_episode

    return f"episode {episode.index}, {film_episode(episode, options, source.name, scratch, say)}"


def about(source: Source) -> dict[str, str]:
    """Metadata that say where an exported file comes from."""
    return {
        "source": source.name,
        "source_sha256": sha256_of(source.paths),
        "run": source.recording.about.get("run", ""),
        "protocol": source.recording.about.get("protocol", ""),
        "version_legpush": version("legpush"),
        "units": "SI: m, rad, s, N; frames: w is the world, its z axis normal to the floor",
    }


def _require_library(made: Format) -> None:
    """Check that the library of a format is installed.

    Raises:
        ConfigError: It is not.
    """
    module, package = LIBRARIES.get(made, ("", ""))
    if module and find_spec(module) is None:
        raise ConfigError(
            f"Expected the library {package} for {made}, which is not installed; pip install 'legpush[view]' "
            "installs it"
        )
