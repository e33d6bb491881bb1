"""Versions of the installed packages."""

import platform

import numpy as np
import pytest

from legpush.messages.common import PROTOCOL_VERSION
from legpush.versions import installed_versions


def test_versions_are_named_and_null_where_nothing_is_installed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("legpush.versions.PACKAGES", {"numpy": "numpy", "nothing": "no-such-distribution"})

    assert installed_versions() == {
        "protocol": str(PROTOCOL_VERSION),
        "python": platform.python_version(),
        "numpy": np.__version__,
        "nothing": None,
    }


def test_everything_that_a_mission_needs_is_installed_here() -> None:
    versions = installed_versions()

    assert {"legpush", "mujoco", "numpy", "ompl", "zenoh"} <= versions.keys()
    assert None not in versions.values()
