"""The built sdist and the wheel from it: what they hold, and that a user without a checkout can work with the wheel."""

import json
import subprocess
import sys
import sysconfig
import tarfile
import venv
from pathlib import Path
from typing import Any
from zipfile import ZipFile

import pytest

PACKAGES = {"planner_proc", "sim_proc", "agent_proc", "legpush"}


@pytest.fixture(scope="module")
def built(root: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of the sdist of this checkout and of the wheel that is built from it, by the declared backend."""
    folder = tmp_path_factory.mktemp("dist")
    build = [sys.executable, "-m", "build", "--no-isolation", "--outdir", str(folder), str(root)]
    subprocess.run(build, check=True, capture_output=True)
    return folder


@pytest.fixture(scope="module")
def wheel(built: Path) -> Path:
    """The wheel."""
    (file,) = built.glob("*.whl")
    return file


@pytest.fixture(scope="module")
def contents(wheel: Path) -> set[str]:
    """The paths in the wheel."""
    with ZipFile(wheel) as archive:
        return set(archive.namelist())


@pytest.fixture(scope="module")
def installed(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Binaries of a virtual environment with the wheel and the dependencies of this one, but not its legpush."""
    home = tmp_path_factory.mktemp("venv")
    venv.create(home, symlinks=True)
    paths = {"base": str(home), "platbase": str(home)}
    site_packages = Path(sysconfig.get_path("purelib", vars=paths))
    (site_packages / "dependencies.pth").write_text(sysconfig.get_path("purelib") + "\n")
    binaries = Path(sysconfig.get_path("scripts", vars=paths))
    pip = [sys.executable, "-m", "pip", "--python", str(binaries / "python"), "install", "-qq", "--no-index"]
    subprocess.run([*pip, "--no-deps", str(wheel)], check=True, capture_output=True)
    return binaries


def output_of(*command: str | Path) -> str:
    """What a command prints, run where the checkout is out of sight; fails with its errors if it does."""
    done = subprocess.run(command, check=False, capture_output=True, text=True, cwd=Path(command[0]).parent)
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


def test_the_wheel_holds_the_four_packages_and_nothing_else(contents: set[str]) -> None:
    tops = {path.split("/")[0] for path in contents}
    assert {top for top in tops if not top.endswith((".dist-info", ".data"))} == PACKAGES


def test_the_examples_travel_with_the_wheel_and_the_sdist(root: Path, built: Path, contents: set[str]) -> None:
    sources = {
        str(path.relative_to(root / "examples"))
        for path in (root / "examples").rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }
    assert sources
    inside = {path.partition("/share/legpush/examples/")[2] for path in contents if ".data/data/share" in path}
    assert inside == sources
    (sdist,) = built.glob("*.tar.gz")
    with tarfile.open(sdist) as archive:
        names = {name.partition("/")[2] for name in archive.getnames()}
    assert {f"examples/{name}" for name in sources} <= names
    assert {"LICENSE", "README.md", "constraints.txt", "shared/legpush/scenarios/default.toml"} <= names


def test_every_file_of_the_packages_is_in_the_wheel(root: Path, contents: set[str]) -> None:
    sources = {
        f"{package}/{path.relative_to(folder)}"
        for package in PACKAGES
        for folder in [root / "shared" / package if package == "legpush" else root / package]
        for path in folder.rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }
    assert sources == {path for path in contents if path.split("/")[0] in PACKAGES}
    assert {f"{package}/py.typed" for package in PACKAGES} <= sources


def test_the_scenario_files_travel_with_the_wheel(contents: set[str]) -> None:
    wanted = {f"legpush/scenarios/{name}.toml" for name in ("default", "published", "push")}
    assert wanted <= contents


def test_the_licence_travels_with_the_wheel(contents: set[str]) -> None:
    assert any(path.endswith(".dist-info/licenses/LICENSE") for path in contents)


@pytest.mark.parametrize("package", sorted(PACKAGES))
def test_a_package_is_imported_from_the_installed_wheel(installed: Path, package: str) -> None:
    found = output_of(installed / "python", "-c", f"import {package}; print({package}.__file__)")
    assert Path(found).is_relative_to(installed.parent)


def test_the_installed_command_tells_its_version(installed: Path, pyproject: dict[str, Any]) -> None:
    assert output_of(installed / "legpush", "--version") == f"legpush {pyproject['project']['version']}"


def test_the_installed_command_lists_its_subcommands(installed: Path) -> None:
    assert "run" in output_of(installed / "legpush", "--help").split()


def test_a_user_copies_scenarios_and_examples_without_a_checkout(installed: Path, tmp_path: Path) -> None:
    legpush = installed / "legpush"
    output_of(legpush, "scenarios", "copy", "push", str(tmp_path / "mine.toml"))
    output_of(legpush, "examples", "copy", str(tmp_path / "examples"))
    assert (tmp_path / "examples" / "grid_planner.py").is_file()
    office = json.loads(
        output_of(legpush, "scenarios", "show", str(tmp_path / "examples/office/office.toml"), "--json")
    )
    assert office["name"] == "office"


def test_a_user_runs_a_mission_without_a_checkout(installed: Path, tmp_path: Path) -> None:
    words = ("run", "push", "--policy", "scripted", "--no-video", "--out", str(tmp_path / "run"), "--json", "--quiet")
    report = json.loads(output_of(installed / "legpush", *words))
    assert report["success"]
    assert report["command"].startswith("legpush run push")
    assert (tmp_path / "run" / "mission.png").is_file()
