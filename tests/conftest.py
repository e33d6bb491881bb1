"""Tests run under the numerics profile, and where they run in parallel, slow files come first.

Quick ones fill the time of the processes that are done early.
"""

import os
import signal
import sys
from typing import Final

import pytest

from legpush.numerics.entry import enter_profile

MOST_PROCESSES: Final = 4


def pytest_xdist_auto_num_workers() -> int:
    """One process more than there are cores: tests that wait for the programs that they started leave cores idle."""
    return min(MOST_PROCESSES, (os.cpu_count() or 1) + 1)


@pytest.hookimpl(tryfirst=True)
def pytest_configure(config: pytest.Config) -> None:
    """Start pytest again under the profile, so that one process computes the bits that child processes compute.

    A process of pytest-xdist has the environment of the one that started it. One that a debugger follows stays as it
    is.
    """
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        # A shell starts what is in its background so, and programs under test would inherit it.
        signal.signal(signal.SIGINT, signal.default_int_handler)
    main = sys.modules["__main__"].__spec__
    if hasattr(config, "workerinput") or (main is not None and main.name.partition(".")[0] != "pytest"):
        return
    capture = config.pluginmanager.getplugin("capturemanager")
    if capture is not None:
        capture.suspend_global_capture(in_=True)
    enter_profile()


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Tests of whole missions first, if this is one of several processes."""
    if hasattr(config, "workerinput"):
        items.sort(key=lambda item: "system" not in item.path.parts)
