"""`constraints.txt` pins exactly what `legpush[all,dev]` installs, and this environment obeys it."""

from importlib.metadata import version
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name
from packaging.version import Version

from .conftest import Declarations

ONLY_FOR_SETUP = {"uv"}
"""What the Makefile and the Dockerfile install with, but legpush never needs."""
GPU_LIBRARIES = ("cuda-", "nvidia-", "triton")
"""What a PyTorch build for GPUs pulls in; the pins are those of the CPU build."""


@pytest.fixture(scope="module")
def pins(root: Path) -> dict[str, str]:
    """Pinned version by canonical name."""
    found: dict[str, str] = {}
    for line in (root / "constraints.txt").read_text().splitlines():
        if line.startswith("#"):
            continue
        requirement = Requirement(line)
        (specifier,) = requirement.specifier
        assert specifier.operator == "==", f"{line} is no exact pin"
        found[canonicalize_name(requirement.name)] = specifier.version
    return found


@pytest.fixture(scope="module")
def needed(declarations: Declarations) -> set[str]:
    """What is installed for running and for checking."""
    return {name for name in declarations.needed("all", "dev") if not name.startswith(GPU_LIBRARIES)}


def test_every_distribution_that_gets_installed_is_pinned_and_no_other(pins: dict[str, str], needed: set[str]) -> None:
    assert {"missing": needed - pins.keys(), "stale": pins.keys() - needed - ONLY_FOR_SETUP} == {
        "missing": set(),
        "stale": set(),
    }


def test_what_is_installed_is_what_is_pinned(pins: dict[str, str], needed: set[str]) -> None:
    installed = {name: Version(version(name)).public for name in needed}
    assert installed == {name: pins[name] for name in needed}


def test_no_pin_names_a_local_build_so_that_any_index_can_serve_it(pins: dict[str, str]) -> None:
    assert [name for name, pinned in pins.items() if Version(pinned).local] == []


def test_every_pin_lies_in_its_declared_range(pins: dict[str, str], declarations: Declarations) -> None:
    outside = [
        f"{requirement}: pinned {pins[canonicalize_name(requirement.name)]}"
        for requirement in declarations.direct("all", "dev")
        if pins[canonicalize_name(requirement.name)] not in requirement.specifier
    ]
    assert outside == []
