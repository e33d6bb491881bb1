"""Figures do not depend on what the user has set up for matplotlib."""

import ast
import os
import subprocess
import sys
from pathlib import Path

import pytest

from agent_proc.figures import Figure, own_style, save_figure
from tests.agent.figures_of_all_kinds import KINDS

HOSTILE = b"text.usetex: True\nfont.size: 30\nsavefig.format: pdf\naxes.facecolor: red\nfigure.dpi: 7\n"
UNREADABLE = b"# K\xfcche\nfont.size: \xff\n"
"""A file that is not UTF-8 stops the import of matplotlib."""
ROOT = Path(__file__).parents[2]
DRAWS = ("agent_proc", "experiments", "benchmarks", "docs")


def draw(folder: Path, **environment: str) -> dict[str, bytes]:
    """All kinds of pictures, drawn in a process with this environment whose working directory is the folder."""
    environment = {**os.environ, "PYTHONPATH": f"{ROOT / 'shared'}:{ROOT}", **environment}
    command = [sys.executable, "-m", "tests.agent.figures_of_all_kinds", str(folder)]
    done = subprocess.run(command, cwd=folder, env=environment, check=False, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return {kind: (folder / f"{kind}.png").read_bytes() for kind in KINDS}


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    return draw(tmp_path_factory.mktemp("undisturbed"))


@pytest.mark.parametrize("rc_file", [HOSTILE, UNREADABLE], ids=["hostile", "unreadable"])
def test_no_setting_of_the_user_reaches_a_picture(
    rc_file: bytes, undisturbed: dict[str, bytes], tmp_path: Path
) -> None:
    for folder in (tmp_path / "cwd", tmp_path / "config", tmp_path / "rc"):
        folder.mkdir()
        (folder / "matplotlibrc").write_bytes(rc_file)
    found = draw(
        tmp_path / "cwd",
        MPLBACKEND="module://nonsense",
        MPLCONFIGDIR=str(tmp_path / "config"),
        MATPLOTLIBRC=str(tmp_path / "rc"),
    )
    assert [kind for kind in KINDS if found[kind] != undisturbed[kind]] == []


def test_a_picture_stays_the_same_when_code_of_the_user_has_changed_the_settings(tmp_path: Path) -> None:
    import matplotlib as mpl

    def picture(name: str) -> bytes:
        with own_style():
            figure = Figure(figsize=(2.0, 1.0))
            figure.add_subplot().set_title("$a$")
            save_figure(figure, tmp_path / name)
        return (tmp_path / name).read_bytes()

    before = picture("before.png")
    with mpl.rc_context({"font.size": 30.0, "axes.facecolor": "red", "savefig.dpi": 7.0}):
        assert picture("after.png") == before
        assert mpl.rcParams["font.size"] == 30.0


def test_the_environment_and_the_working_directory_are_back_after_the_import(tmp_path: Path) -> None:
    (tmp_path / "matplotlibrc").write_bytes(HOSTILE)
    code = "import agent_proc.figures, os; print(os.getcwd(), os.environ['MPLBACKEND'], os.environ.get('MATPLOTLIBRC'))"
    environment = {name: value for name, value in os.environ.items() if name != "MATPLOTLIBRC"}
    environment |= {"MPLBACKEND": "module://nonsense"}
    command = [sys.executable, "-P", "-c", code]
    said = subprocess.run(command, cwd=tmp_path, env=environment, check=True, capture_output=True, text=True).stdout
    assert said.split() == [str(tmp_path), "module://nonsense", "None"]


def test_only_one_module_imports_matplotlib() -> None:
    paths = [path for package in DRAWS for path in (ROOT / package).rglob("*.py")]
    importers = set()
    for path in paths:
        for node in ast.walk(ast.parse(path.read_text())):
            names = [node.module or ""] if isinstance(node, ast.ImportFrom) else []
            names += [each.name for each in node.names] if isinstance(node, ast.Import) else []
            if any(name.split(".")[0] == "matplotlib" for name in names):
                importers.add(str(path.relative_to(ROOT)))
    assert importers == {"agent_proc/figures.py"}
