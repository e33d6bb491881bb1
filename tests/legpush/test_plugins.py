"""Plug-ins are found through the entry points of installed packages, and what cannot be used names its package."""

from pathlib import Path

import pytest

from legpush.errors import LegpushError, PluginError
from legpush.plugins import Group, load_plugin, plugin_names

MODULES = {
    "good": "def make():\n    return 'made'\n",
    "broken": "raise ValueError('half written')\n",
    "lacking": "import a_library_that_is_not_there\n",
}
ENTRY_POINTS = """
[legpush.policies]
good = good:make
broken = broken:make
lacking = lacking:make
lacking_extra = lacking:make [learning]
absent = good:nothing
no_module = no_such_module:make
"""


def install(folder: Path, package: str, entry_points: str) -> None:
    info = folder / f"{package}-1.0.dist-info"
    info.mkdir(parents=True)
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {package}\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(entry_points)


@pytest.fixture
def installed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A package of somebody else's, installed."""
    install(tmp_path, "their-robots", ENTRY_POINTS)
    for name, source in MODULES.items():
        (tmp_path / f"{name}.py").write_text(source)
    monkeypatch.syspath_prepend(tmp_path)
    return tmp_path


def test_what_a_package_registers_is_found_by_its_name(installed: Path) -> None:
    assert "good" in plugin_names("legpush.policies")
    assert load_plugin("legpush.policies", "good")() == "made"


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("broken", r"policy 'broken' of the package their-robots .* broken:make \(ValueError: half written\)"),
        ("lacking", r"package their-robots needs a_library_that_is_not_there, which is not installed$"),
        ("lacking_extra", r"pip install 'their-robots\[learning\]' installs it"),
        ("absent", r"package their-robots cannot be imported from good:nothing \(AttributeError"),
        ("no_module", r"package their-robots needs no_such_module"),
    ],
)
def test_what_cannot_be_imported_names_its_package_and_why(installed: Path, name: str, text: str) -> None:
    with pytest.raises(PluginError, match=text):
        load_plugin("legpush.policies", name)


def test_a_name_that_two_packages_use_is_refused(installed: Path) -> None:
    install(installed, "other-robots", "[legpush.policies]\ngood = broken:make\n")
    with pytest.raises(PluginError, match="Expected one policy called 'good', got 2, from other-robots, their-robots"):
        load_plugin("legpush.policies", "good")


@pytest.mark.parametrize(
    ("group", "name"),
    [
        ("legpush.planners", "ompl"),
        ("legpush.simulators", "mujoco"),
        ("legpush.policies", "scripted"),
        ("legpush.policies", "fixed"),
        ("legpush.policies", "variable"),
        ("legpush.missions", "push"),
    ],
)
def test_our_own_are_registered_in_the_same_way(group: Group, name: str) -> None:
    assert name in plugin_names(group)
    assert callable(load_plugin(group, name))


def test_an_unknown_name_is_answered_with_the_valid_ones() -> None:
    with pytest.raises(PluginError, match=r"Expected a simulator \(.*mujoco.*\), got 'gazebo'") as caught:
        load_plugin("legpush.simulators", "gazebo")
    assert isinstance(caught.value, LegpushError)
    assert caught.value.exit_code == 2
