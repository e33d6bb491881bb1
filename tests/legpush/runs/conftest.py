"""Runs that are shown in a temporary directory of the test."""

import tempfile
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from legpush.runs.live_runs import LiveRun, shown, socket_directory

AT = ("unixsock-stream//tmp/legpush-x/agent.sock", "unixsock-stream//tmp/legpush-x/sim0.sock")


@pytest.fixture(autouse=True)
def temporary(monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A temporary directory of its own, with a path that is short enough for sockets."""
    with tempfile.TemporaryDirectory(prefix="runs-", dir="/tmp") as folder:
        monkeypatch.setattr(tempfile, "tempdir", None)
        monkeypatch.setenv("TMPDIR", folder)
        monkeypatch.delenv("LEGPUSH_RUN", raising=False)
        yield Path(folder)


@pytest.fixture
def launch() -> Iterator[Callable[..., Path]]:
    """Shows a run until the test is over, and returns its directory."""
    with ExitStack() as stack:

        def start(name: str = "r1", folder: Path | None = Path("/runs/r1"), kind: str = "train") -> Path:
            directory = stack.enter_context(socket_directory())
            stack.enter_context(shown(LiveRun.now(name, kind, folder, AT), directory))
            return directory

        yield start
