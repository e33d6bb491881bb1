"""The recorder as a child process: its command line, and its last words."""

import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Final

from legpush.bus.endpoints import Endpoints
from legpush.processes.child import Process

NOTES_AT_MOST: Final = 10_000
INCOMPLETE: Final = 1
"""Exit code of a recorder whose recording is whole, but lacks something."""


def recorder_arguments(
    file: Path, run: str, endpoints: Endpoints, about: Mapping[str, str] | None = None
) -> tuple[str, ...]:
    """The command line of a recorder; `about` becomes metadata of the recording."""
    argv = [sys.executable, "-P", "-m", "legpush.entry", "legpush.launch.record", str(file.absolute()), "--run", run]
    argv += ["--listen", *endpoints.listen, "--connect", *endpoints.connect]
    if endpoints.credentials is not None:
        argv += ["--secure", str(endpoints.credentials.folder)]
    for name, value in (about or {}).items():
        argv += ["--about", f"{name}={value}"]
    return tuple(argv)


def what_is_missing(process: Process) -> list[str]:
    """What a recorder that came to its end said about its recording."""
    words = process.last_words(NOTES_AT_MOST)
    start = max((i for i, line in enumerate(words) if line.startswith("wrote ")), default=len(words))
    return [line.strip() for line in words[start + 1 :]]
