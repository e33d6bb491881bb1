"""Versions are noted by the names that readers of reports and recordings know."""

import platform
from importlib.metadata import version

import pytest

from legpush import versions
from legpush.messages.common import PROTOCOL_VERSION
from legpush.versions import Package, installed_versions, recorder_versions


def test_reports_name_what_a_mission_depends_on() -> None:
    found = installed_versions()
    names = "numerics motions protocol python glibc legpush zenoh mujoco ompl numpy scipy msgpack msgspec matplotlib"
    assert list(found) == names.split()
    assert (found["protocol"], found["python"]) == (str(PROTOCOL_VERSION), platform.python_version())
    assert found["zenoh"] == version("eclipse-zenoh")


def test_recordings_name_what_a_recorder_runs_with_by_distribution() -> None:
    assert recorder_versions() == {
        name: version(name) for name in ("legpush", "eclipse-zenoh", "mcap", "msgpack", "msgspec")
    }


def test_a_package_that_is_not_installed_has_no_version(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(versions, "PACKAGES", (Package("no-such-package", "none", ("report",)),))
    assert installed_versions()["none"] is None
