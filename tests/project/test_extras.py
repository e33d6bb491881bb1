"""Each process runs with what its own extra installs: a planner host needs neither PyTorch nor MuJoCo."""

import ast
import subprocess
import sys
from collections.abc import Iterator, Mapping
from functools import cache
from importlib.metadata import packages_distributions
from pathlib import Path

import pytest
from packaging.utils import canonicalize_name

from .conftest import Declarations

OWN = {"planner_proc", "sim_proc", "agent_proc", "legpush"}
"""Packages that are installed."""
PARTS = [
    ("shared/legpush", ("core",)),
    ("shared/legpush/gym", ("train",)),
    ("shared/legpush/study", ("agent",)),
    ("shared/legpush/study/engines", ("ray", "slurm")),
    ("planner_proc", ("planner",)),
    ("sim_proc", ("sim",)),
    ("sim_proc/export", ("view",)),
    ("sim_proc/scene_3d", ("view",)),
    ("sim_proc/view", ("view",)),
    ("agent_proc", ("agent",)),
    ("agent_proc/gym_envs.py", ("train",)),
    ("agent_proc/learning", ("train",)),
    ("agent_proc/mission_env", ("train",)),
    ("agent_proc/policies/sb3", ("train",)),
    ("agent_proc/learning/loggers/wandb_log.py", ("wandb",)),
    ("agent_proc/studies", ("train",)),
    ("agent_proc/studies/tuning", ("tune",)),
    ("agent_proc/policies/onnx_file.py", ("train",)),
]
"""Source folder or module, without those in it that are parts themselves, and the extras that its hosts install."""
BESIDE = [
    ("benchmarks", ("bench",)),
    ("docs", ("all", "docs")),
    ("examples", ()),
    ("experiments", ("bench",)),
    ("tests", ("all", "dev")),
]
"""The same for folders of the checkout that are not installed."""

FOR_TRAINING = {"tensorboard"}
"""Declared for those who train policies: Stable-Baselines3 imports it where a log is asked for, none of ours does."""

IMPORT_ALL = """
import importlib, pkgutil, sys

class Absent:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in absent:
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)

package, others, *absent = sys.argv[1:]
sys.meta_path.insert(0, Absent())
top = importlib.import_module(package)
path = getattr(top, "__path__", ())
names = [package, *(module.name for module in pkgutil.walk_packages(path, package + "."))]
names = [name for name in names if not any(f"{name}.".startswith(f"{other}.") for other in others.split())]
for name in names:
    importlib.import_module(name)
print(len(names))
"""
"""Imports every module of a package, but for some packages in it, on a host where some top-level modules are absent,
and prints how many it did."""


@cache
def providers() -> Mapping[str, set[str]]:
    """Canonical names of the installed distributions that provide each top-level module."""
    return {module: {canonicalize_name(name) for name in names} for module, names in packages_distributions().items()}


def parts_in(folder: str) -> list[str]:
    """Those below it."""
    return [part for part, _ in PARTS if part.startswith(f"{folder}/")]


def module_name(folder: str) -> str:
    """What a source folder is imported as."""
    return folder.removeprefix("shared/").removesuffix(".py").replace("/", ".")


def foreign_imports(root: Path, folder: str) -> Iterator[tuple[Path, str]]:
    """Every import in a folder, also inside functions, of a top-level module that is neither ours nor Python's."""
    others = parts_in(folder)
    beside = dict(BESIDE)
    ours = OWN | beside.keys() | {path.stem for path in (root / folder).glob("*.py")} if folder in beside else OWN
    for path in sorted((root / folder).rglob("*.py")) or [root / folder]:
        if any(path.is_relative_to(root / other) for other in others):
            continue
        for node in ast.walk(ast.parse(path.read_text())):
            match node:
                case ast.Import():
                    names = [alias.name for alias in node.names]
                case ast.ImportFrom(module=str(module), level=0):
                    names = [module]
                case _:
                    continue
            for top in {name.partition(".")[0] for name in names}:
                if top not in ours and top not in sys.stdlib_module_names:
                    yield path, top


@pytest.mark.parametrize(("folder", "extras"), PARTS + BESIDE)
def test_a_folder_imports_only_what_its_extras_declare(
    root: Path, declarations: Declarations, folder: str, extras: tuple[str, ...]
) -> None:
    declared = {canonicalize_name(requirement.name) for requirement in declarations.direct(*extras)}
    undeclared = [
        f"{path.relative_to(root)} imports {module}"
        for path, module in foreign_imports(root, folder)
        if not providers().get(module, {canonicalize_name(module)}) & declared
    ]
    assert undeclared == []


def test_everything_that_is_declared_is_imported(root: Path, declarations: Declarations) -> None:
    imported = {
        name for folder, _ in PARTS for _, module in foreign_imports(root, folder) for name in providers()[module]
    }
    declared = {canonicalize_name(requirement.name) for requirement in declarations.direct("all")}
    assert declared - imported == FOR_TRAINING


@pytest.mark.parametrize(("folder", "extras"), PARTS)
def test_every_module_of_a_process_is_imported_where_only_its_extra_is_installed(
    declarations: Declarations, folder: str, extras: tuple[str, ...]
) -> None:
    present = declarations.needed(*extras) | {"legpush"}
    absent = [
        module for module, names in providers().items() if not names & present and module not in sys.stdlib_module_names
    ]
    assert "pytest" in absent
    done = subprocess.run(
        [sys.executable, "-c", IMPORT_ALL, module_name(folder), " ".join(map(module_name, parts_in(folder))), *absent],
        check=False,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    assert int(done.stdout) > 0


def test_a_mission_needs_what_the_hosts_of_its_processes_need(declarations: Declarations) -> None:
    hosts = {str(each) for group in ("core", "planner", "sim", "agent") for each in declarations.of_group(group)}
    assert {str(each) for each in declarations.direct()} == hosts


@pytest.mark.parametrize("extra", ["planner", "sim", "agent", "view"])
def test_no_extra_but_that_of_training_installs_pytorch(declarations: Declarations, extra: str) -> None:
    learning = {"torch", "stable-baselines3", "gymnasium", "tensorboard"}
    assert learning <= declarations.needed("train")
    assert not learning & declarations.needed(extra)


@pytest.mark.parametrize("extra", ["planner", "agent"])
def test_no_host_but_that_of_the_simulator_installs_mujoco(declarations: Declarations, extra: str) -> None:
    assert "mujoco" in declarations.needed("sim")
    assert "mujoco" not in declarations.needed(extra)
