"""What `import legpush` offers, and that our own code does not go through it."""

import ast
import pkgutil
from pathlib import Path

import pytest

import legpush
from legpush.lockstep.mission import Mission
from legpush.lockstep.simulator import Stepper
from legpush.plans.planner import MakePlans
from legpush.plugins import load_plugin

PACKAGES = ("planner_proc", "sim_proc", "agent_proc", "shared/legpush")


@pytest.mark.parametrize("name", legpush.__all__)
def test_every_public_name_exists_and_is_documented(name: str) -> None:
    value = getattr(legpush, name)
    assert name in dir(legpush)
    assert isinstance(value, str) or value.__doc__


def test_no_public_name_is_that_of_a_module() -> None:
    modules = {module.name for module in pkgutil.iter_modules(legpush.__path__)}
    assert not modules & set(legpush.__all__)


def test_an_unknown_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="module 'legpush' has no attribute 'walk'"):
        legpush.walk  # noqa: B018


@pytest.mark.parametrize("package", PACKAGES)
def test_product_code_imports_modules_not_the_public_face(root: Path, package: str) -> None:
    through_the_face = []
    for path in sorted((root / package).rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.ImportFrom) and node.module == "legpush":
                names = {alias.name for alias in node.names}
                through_the_face += [f"{path.relative_to(root)}: {name}" for name in names & set(legpush.__all__)]
            if isinstance(node, ast.Import) and "legpush" in {alias.name for alias in node.names}:
                through_the_face.append(str(path.relative_to(root)))
    assert through_the_face == []


def test_our_plug_ins_fulfil_the_protocols_of_their_groups() -> None:
    from agent_proc.mission.local import run_local
    from planner_proc.planning import make_plans
    from sim_proc.simulator import Simulator

    planner: MakePlans = make_plans
    simulator: Stepper = Simulator()
    mission: Mission = run_local
    assert load_plugin("legpush.planners", "ompl") is planner
    assert isinstance(simulator, load_plugin("legpush.simulators", "mujoco"))
    assert load_plugin("legpush.missions", "push") is mission
