"""Every import contract can be broken: a rogue import that it is there to stop makes it fail."""

import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

ROGUES = {
    "The processes never import each other": ("agent_proc", "import sim_proc"),
    "What they share imports none of them": ("legpush", "import planner_proc"),
    "Planner and simulator load no learning library": ("sim_proc", "import torch"),
    "Only planner_proc.search.ompl_search, steering and dubins import OMPL": ("planner_proc", "from ompl import base"),
    "Only the simulator's model, scenery, physics and pictures import MuJoCo": ("sim_proc", "import mujoco"),
    "Only two modules of sim_proc.export import Foxglove": ("sim_proc", "import foxglove"),
    "Only sim_proc.view imports viser": ("sim_proc", "import viser"),
    "Only tables import PyArrow": ("agent_proc", "import pyarrow"),
    "Only legpush.bus.bus imports Zenoh": ("legpush", "import zenoh"),
    "Only legpush.recording.mcap_* import MCAP": ("legpush", "import mcap"),
    "Only legpush.scenarios.map_server imports Pillow and PyYAML": ("legpush", "import yaml"),
    "Only the agent's pictures import matplotlib": (
        "agent_proc",
        "from matplotlib import pyplot",
    ),
}
"""Package and line that must break the contract of that name."""


@pytest.fixture
def copy(root: Path, tmp_path: Path) -> Path:
    """A copy of the packages and their contracts that a test may spoil."""
    for package in ("planner_proc", "sim_proc", "agent_proc", "shared/legpush"):
        shutil.copytree(root / package, tmp_path / Path(package).name)
    shutil.copy(root / "pyproject.toml", tmp_path)
    return tmp_path


def test_there_is_a_rogue_import_for_every_contract(pyproject: dict[str, Any]) -> None:
    assert ROGUES.keys() == {contract["name"] for contract in pyproject["tool"]["importlinter"]["contracts"]}


@pytest.mark.parametrize("contract", ROGUES)
def test_a_rogue_import_breaks_its_contract(copy: Path, contract: str) -> None:
    package, line = ROGUES[contract]
    (copy / package / "rogue.py").write_text(line + "\n")
    lint = subprocess.run(
        [Path(sys.executable).with_name("lint-imports"), "--no-cache"],
        cwd=copy,
        check=False,
        capture_output=True,
        text=True,
    )
    assert f"{contract} BROKEN" in lint.stdout
    assert f"{package}.rogue" in lint.stdout
