"""The list of studies in `experiments/README.md`, from the comments at the heads of their files."""

import re
from pathlib import Path
from typing import Final

ROOT: Final = Path(__file__).parents[1]
FOLDERS: Final = ("experiments/studies", "benchmarks/studies")
_TIME: Final = re.compile(r" ?CPU time: (?P<time>[^.]+)\.")
_CELL: Final = re.compile(r"--cell [\w.]+:\w+")
_WORKERS: Final = re.compile(r" To compare times, give --workers 1\.")
_ENVIRONMENT: Final = re.compile(r"NUMBA_DISABLE_JIT=1")


class CommentError(Exception):
    """A study file whose comment does not say how long it takes."""


def study_list(folder: str) -> str:
    """Return a table of the studies in a folder: what each does, its CPU time, and the command that runs it.

    Raises:
        CommentError: A file does not say what it does or how long it takes.
    """
    lines = ["| what | CPU time | command |", "| --- | --- | --- |"]
    return "\n".join([*lines, *(_line(path) for path in sorted((ROOT / folder).glob("*.toml")))])


def command_of(path: Path) -> str:
    """Return the command that runs a study."""
    comment = comment_of(path)
    file = path.relative_to(ROOT).as_posix()
    words = ["legpush study run", file, f"--out runs/{path.stem}", *_CELL.findall(comment)[:1]]
    words += ["--workers 1"] * bool(_WORKERS.search(comment))
    return " ".join([*_ENVIRONMENT.findall(comment)[:1], *words])


def comment_of(path: Path) -> str:
    """Return the comment at the head of a study file."""
    lines = []
    for line in path.read_text().splitlines():
        if not line.startswith("#"):
            break
        lines.append(line.removeprefix("#").strip())
    return " ".join(lines)


def _line(path: Path) -> str:
    comment = comment_of(path)
    time = _TIME.search(comment)
    if time is None or not time.start():
        raise CommentError(f"{path}: expected a comment such as `# What it does. CPU time: 5 min.`, got {comment!r}")
    return f"| {_WORKERS.sub('', comment[: time.start()])} | {time['time']} | `{command_of(path)}` |"
