"""Every import contract can be broken: a rogue import that it is there to stop makes it fail."""

import re
import shutil
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import pytest

ROGUES = {
    "The processes never import each other": ("agent_proc.push_model", "import sim_proc.gravity"),
    "What they share imports none of them": ("legpush.launch", "import planner_proc.planning"),
    "Planner and simulator load no learning library": ("sim_proc.export", "import torch"),
    "Processes import options, not the launcher": ("agent_proc.programs", "from legpush.launch import run"),
    "legpush is built in layers": ("legpush.scene", "from legpush.messages import codec"),
    "History is read without a bus": ("legpush.history", "from legpush.bus import keys"),
    "The planner is built in layers": ("planner_proc.clearance", "from planner_proc.smoothing import spline"),
    "The conformance check knows no planner": ("planner_proc.conformance", "from planner_proc.box import pushes"),
    "The simulator is built in layers": ("sim_proc.model", "from sim_proc.control import balance"),
    "Pictures do not reach the physics": ("sim_proc.render", "from sim_proc import simulator"),
    "Control knows no MuJoCo": ("sim_proc.control", "from sim_proc.model import world"),
    "The agent is built in layers": ("agent_proc.task", "from agent_proc.policies import scripted"),
    "No circles between siblings": ("planner_proc.search", "from planner_proc import planning"),
    "Only the bus's session imports Zenoh": ("legpush.bus", "import zenoh"),
    "Only two modules import MuJoCo: without OpenGL, and for films": ("sim_proc.model", "import mujoco"),
    "Only two modules import cryptography: one signs certificates, one reads them": (
        "legpush.bus.secure",
        "from cryptography import x509",
    ),
    "Only one module imports Numba": ("sim_proc.physics", "import numba"),
    "Only three modules of the planner import OMPL": ("planner_proc.search", "from ompl import base"),
    "Missions and evaluations load no learning library": (
        "agent_proc.evaluation",
        "from agent_proc.learning import env",
    ),
    "Only learning and policies.sb3 import PyTorch and Stable-Baselines3": (
        "agent_proc.policies",
        "import stable_baselines3",
    ),
    "Only learning, mission_env, policies.sb3 and legpush.gym import Gymnasium": (
        "agent_proc.task",
        "import gymnasium",
    ),
    "Only the file of weights imports safetensors": ("agent_proc.policies", "from safetensors.numpy import load"),
    "Only agent_proc.policies.onnx_file imports ONNX": ("agent_proc.policies", "import onnx"),
    "Only agent_proc.figures imports matplotlib": ("agent_proc.reporting", "from matplotlib import pyplot"),
    "Only legpush.recording.mcap_file imports MCAP": ("legpush.recording", "import mcap"),
    "Only legpush.scenarios.maps.map_image imports Pillow": ("legpush.scenarios", "import PIL"),
    "Only legpush.scenarios.maps.map_yaml imports PyYAML": ("legpush.scenarios", "import yaml"),
    "Only agent_proc.learning.window imports pygame": ("agent_proc.learning", "import pygame"),
    "Only one module imports tyro": ("legpush.recording", "import tyro"),
    "Only two modules of sim_proc.export import Foxglove": ("sim_proc.export", "import foxglove"),
    "Only tables import PyArrow": ("sim_proc.export", "import pyarrow"),
    "Only the page and its scene import viser": ("sim_proc.view", "import viser"),
    "Only the guard of the page imports websockets": ("sim_proc.view", "import websockets"),
    "Only the trials of a tuning import Optuna": ("agent_proc.studies.tuning", "import optuna"),
    "Only its logger imports Weights & Biases": ("agent_proc.learning.loggers", "import wandb"),
    "Only the engine of Ray imports Ray": ("legpush.study.engines", "import ray"),
    "Only the check of Ray's token imports gRPC": ("legpush.study.engines", "import grpc"),
    "Only the engine of Slurm imports submitit": ("legpush.study.engines", "import submitit"),
}
"""Package that a rogue module is put into, and the line in it that must break the contract of that name."""

CIRCLES = "No circles between siblings"
"""The contract whose report names packages, but no module: its rogue is alone in the packages, so that no other one
closes a circle."""
CLOSED = ".search -> .planning (1 import)"
"""The import that closes a circle, as the report names it."""


@pytest.fixture(scope="module")
def packages(root: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a copy of the packages and their contracts."""
    folder = tmp_path_factory.mktemp("packages")
    for package in ("planner_proc", "sim_proc", "agent_proc", "shared/legpush"):
        shutil.copytree(root / package, folder / Path(package).name)
    shutil.copy(root / "pyproject.toml", folder)
    return folder


@pytest.fixture(scope="module")
def reports(packages: Path) -> dict[str, str]:
    """What is said about each broken contract, by its name, with all rogues in place."""
    alone = lint(packages, [CIRCLES])
    return lint(packages, ROGUES.keys() - {CIRCLES}) | {CIRCLES: alone.get(CIRCLES, "")}


def rogue_module(contract: str) -> str:
    """Address of the rogue module that breaks a contract."""
    return f"{ROGUES[contract][0]}.rogue_{list(ROGUES).index(contract)}"


def lint(packages: Path, contracts: Iterable[str]) -> dict[str, str]:
    """Check all contracts with the rogue modules of some in place, and remove those again."""
    files = {packages / f"{rogue_module(name).replace('.', '/')}.py": ROGUES[name][1] for name in contracts}
    for file, line in files.items():
        file.write_text(line + "\n")
    command = [str(Path(sys.executable).with_name("lint-imports")), "--no-cache"]
    done = subprocess.run(command, cwd=packages, check=False, capture_output=True, text=True)
    for file in files:
        file.unlink()
    _, title, broken = done.stdout.partition("Broken contracts\n")
    assert title, done.stdout + done.stderr
    # Each report stands below its contract's name, which is underlined.
    _, *parts = re.split(r"^(.+)\n-{3,}$", broken, flags=re.MULTILINE)
    return dict(zip(parts[::2], parts[1::2], strict=True))


def test_there_is_a_rogue_import_for_every_contract(pyproject: dict[str, Any]) -> None:
    assert ROGUES.keys() == {contract["name"] for contract in pyproject["tool"]["importlinter"]["contracts"]}


@pytest.mark.parametrize("contract", ROGUES)
def test_a_rogue_import_breaks_its_contract(reports: dict[str, str], contract: str) -> None:
    assert contract in reports
    assert (CLOSED if contract == CIRCLES else rogue_module(contract)) in reports[contract]
