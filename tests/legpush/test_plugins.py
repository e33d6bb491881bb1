"""Plug-ins are found through the entry points of installed packages, and what cannot be used names its package."""

import sys
from importlib.metadata import packages_distributions, requires
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from legpush.errors import LegpushError, PluginError
from legpush.plugins import LIBRARIES, Group, is_address, load_address, load_plugin, plugin_names

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


ADDRESSES = {
    "none:make": r"\(the module none_of_mine is not on the Python path\)",
    "lacks": r"\(ModuleNotFoundError: it needs the module a\.library, which is not on the Python path\)",
    "ours": r"\(ModuleNotFoundError: it needs onnx, .*; pip install 'legpush\[train\]' installs it\)",
    "syntax": r"\(SyntaxError: .*\)",
    "divides": r"\(ZeroDivisionError: division by zero\)",
    "exits": r"\(SystemExit: 7\)",
    "nameless": r"\(ModuleNotFoundError\)",
}
SOURCES = {
    "lacks": "raise ModuleNotFoundError('no', name='a.library')",
    "ours": "raise ModuleNotFoundError('no', name='onnx.helper')",
    "syntax": "def",
    "divides": "1 / 0",
    "exits": "import sys; sys.exit(7)",
    "nameless": "raise ModuleNotFoundError",
}


@pytest.mark.parametrize("name", ADDRESSES)
def test_a_module_of_the_user_that_cannot_be_imported_is_named_with_what_it_needs(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys, "path", [*sys.path])
    monkeypatch.delitem(sys.modules, "onnx", raising=False)
    monkeypatch.chdir(tmp_path)
    module = f"{name.partition(':')[0]}_of_mine"
    if name in SOURCES:
        (tmp_path / f"{module}.py").write_text(SOURCES[name])
    with pytest.raises(PluginError, match=rf"^Expected a thing, got '{module}:make' {ADDRESSES[name]}$"):
        load_address(f"{module}:make", "a thing")


@pytest.mark.parametrize("address", ["two words:make", " spaced:make", "spaced:make ", "spaced:", ":make", "spaced"])
def test_what_is_no_address_is_not_imported(address: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for name in ("two words", " spaced", "spaced"):
        (tmp_path / f"{name}.py").write_text("open('ran', 'w').close()")
    with pytest.raises(PluginError, match=f"^Expected a thing, got '{address}', which is no module:name"):
        load_address(address, "a thing")
    assert not is_address(address)
    assert not (tmp_path / "ran").exists()


def test_the_libraries_of_the_extras_are_those_of_the_distribution() -> None:
    provided = packages_distributions()
    required = [Requirement(text) for text in requires("legpush") or ()]
    for module, extra in LIBRARIES.items():
        assert module in provided, f"{module} is not installed"
        names = {canonicalize_name(name) for name in provided[module]}
        assert any(
            canonicalize_name(each.name) in names and (each.marker is None or each.marker.evaluate({"extra": extra}))
            for each in required
        ), f"the extra {extra} does not install {module}"
