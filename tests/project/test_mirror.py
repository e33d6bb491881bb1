"""Every module has a test file of its name in the mirrored folder, or `tests/README.md` says what covers it."""

import re
from pathlib import Path

import pytest

MIRRORED = {"shared/legpush": "legpush"}
"""Package to the folder of its tests."""
ROW = re.compile(r"^\| `(?P<module>(?!\S*/test_)[\w/]+\.py)` \| (?P<covered_by>.+) \|$", re.MULTILINE)


@pytest.fixture(scope="module")
def listed(root: Path) -> dict[str, str]:
    """Module to what covers it."""
    return {row["module"]: row["covered_by"] for row in ROW.finditer((root / "tests" / "README.md").read_text())}


def modules(root: Path, package: str) -> list[Path]:
    """Modules of a package, relative to it, without those that say only what it is."""
    folder = root / package
    return sorted(path.relative_to(folder) for path in folder.rglob("*.py") if path.name not in ("__init__.py",))


@pytest.mark.parametrize("package", MIRRORED)
def test_every_module_has_a_test_file_or_is_listed_and_not_both(
    root: Path, listed: dict[str, str], package: str
) -> None:
    tests = MIRRORED[package]
    found = modules(root, package)
    assert found
    without = {
        f"{tests}/{module}"
        for module in found
        if not (root / "tests" / tests / module.with_name(f"test_{module.name}")).exists()
    }
    assert without == {module for module in listed if module.startswith(f"{tests}/")}


def test_what_is_listed_as_covering_a_module_is_there(root: Path, listed: dict[str, str]) -> None:
    files = [file for covered_by in listed.values() for file in re.findall(r"`([\w/]+\.py)`", covered_by)]
    assert len(files) > 20
    assert [file for file in files if not (root / "tests" / file).exists()] == []
