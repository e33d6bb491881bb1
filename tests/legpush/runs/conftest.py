"""Runs that are shown in a temporary directory of the test."""

import tempfile
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from legpush.runs.live_runs import LiveRun, shown, socket_directory

AT = ("unixsock-stream//tmp/legpush-x/agent.sock", "unixsock-stream//tmp/legpush-x/sim0.sock")


@pytest.fixture(autouse=True)
def temporary(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A temporary directory of its own."""
    monkeypatch.setattr(tempfile, "tempdir", None)
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    monkeypatch.delenv("LEGPUSH_RUN", raising=False)
    return tmp_path


@pytest.fixture
def launch() -> Iterator[Callable[..., Path]]:
    """Shows a run until the test is over, and returns its directory."""
    with ExitStack() as stack:

        def start(name: str = "r1", folder: Path | None = Path("/runs/r1"), kind: str = "train") -> Path:
            directory = stack.enter_context(socket_directory())
            stack.enter_context(shown(LiveRun.now(name, kind, folder, AT), directory))
            return directory

        yield start
