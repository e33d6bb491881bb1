"""What `legpush doctor` says about libraries."""

from importlib.metadata import PackageNotFoundError

import pytest

from legpush.doctor import packages
from legpush.doctor.packages import package_findings

NEEDS = ["msgspec>=0.22", 'ompl>=2; extra == "planner"', 'torch>=2; extra == "train"', 'scipy>=1; extra == "planner"']


@pytest.fixture
def installed(monkeypatch: pytest.MonkeyPatch) -> dict[str, str]:
    found = {"legpush": "1.0", "msgspec": "0.22", "ompl": "2.0", "scipy": "1.5", "torch": "2.1"}

    def version(name: str) -> str:
        if name not in found:
            raise PackageNotFoundError(name)
        return found[name]

    monkeypatch.setattr(packages, "requires", lambda _: NEEDS)
    monkeypatch.setattr(packages, "version", version)
    return found


def test_what_is_there_is_told_with_its_versions(installed: dict[str, str]) -> None:
    told = {finding.name: finding for finding in package_findings()}
    assert told["libraries"].detail == "every command: msgspec 0.22"
    assert told["[planner]"].detail == "planning paths: ompl 2.0, scipy 1.5"
    assert {finding.state for finding in told.values()} == {"ok"}
    assert len(told) > len(installed)


def test_a_mission_needs_its_libraries_and_a_training_does_not_stop_it(installed: dict[str, str]) -> None:
    del installed["torch"]
    installed["ompl"] = "1.9"
    told = {finding.name: finding for finding in package_findings()}
    assert (told["[train]"].state, told["[train]"].cure) == ("note", "pip install 'legpush[train]'")
    assert told["[planner]"].state == "missing"
    assert "ompl 1.9 is installed, expected >=2" in told["[planner]"].detail
