"""Folders and modules stay small, packages say what they are for, and each test lies where its module is mirrored."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

PACKAGES = ("planner_proc", "sim_proc", "agent_proc", "shared/legpush")
PRODUCT = (*PACKAGES, "experiments", "benchmarks")
WITHOUT_LIMIT_OF_FOLDERS = ("tests", "docs", "examples")
"""Folders of code where only the length of a module is limited."""
MAX_MODULES = 16
MAX_LINES = 300
MIRRORED = {
    "legpush": "shared/legpush",
    "sim": "sim_proc",
    "planner": "planner_proc",
    "agent": "agent_proc",
}
"""Folder in `tests` to the package that it mirrors."""
UNMIRRORED = (
    "system",
    "compatibility",
    "project",
    "benchmarks",
    "experiments",
    "examples",
    "docs",
    "security",
    "faults",
)
"""Folders in `tests` that mirror no package."""


def modules(root: Path, *folders: str) -> Iterator[Path]:
    for folder in folders:
        found = sorted((root / folder).rglob("*.py"))
        assert found, f"there is no module in {folder}"
        yield from found


def folders_of_code(root: Path, *folders: str) -> list[Path]:
    """Every folder with a module, with all folders that lead to it."""
    found = {path.parent for path in modules(root, *folders)}
    tops = [root / folder for folder in folders]
    return sorted({each for path in found for each in (path, *path.parents) if any(map(each.is_relative_to, tops))})


def named_in_the_readme(root: Path) -> list[str]:
    """The test files that a table of `tests/README.md` names, relative to `tests`."""
    rows = re.findall(r"^\|.*\|$", (root / "tests" / "README.md").read_text(), re.MULTILINE)
    return [file for row in rows for file in re.findall(r"`((?:\w+/)*test_\w+\.py)`", row)]


def assert_none_above(limit: int, counts: dict[str, int]) -> None:
    above = [f"{name} has {n}, at most {limit} are allowed" for name, n in counts.items() if n > limit]
    assert not above, "\n".join(above)


def test_no_folder_of_product_code_has_more_than_16_modules_of_its_own(root: Path) -> None:
    n_modules = {
        str(folder.relative_to(root)): len([path for path in folder.glob("*.py") if path.name != "__init__.py"])
        for folder in folders_of_code(root, *PRODUCT)
    }
    assert_none_above(MAX_MODULES, n_modules)


def test_no_module_is_longer_than_300_lines(root: Path) -> None:
    n_lines = {
        str(path.relative_to(root)): path.read_text().count("\n")
        for path in modules(root, *PRODUCT, *WITHOUT_LIMIT_OF_FOLDERS)
    }
    assert_none_above(MAX_LINES, n_lines)


def test_every_folder_of_a_package_says_what_it_is_for(root: Path) -> None:
    silent = []
    for folder in folders_of_code(root, *PACKAGES):
        package = folder / "__init__.py"
        if not package.exists() or not ast.get_docstring(ast.parse(package.read_text())):
            silent.append(str(folder.relative_to(root)))
    assert silent == []


def test_every_test_file_mirrors_a_module_or_package_or_is_named_in_the_readme_of_the_tests(root: Path) -> None:
    tests, named, strays = root / "tests", named_in_the_readme(root), []
    for path in modules(root, "tests"):
        file = path.relative_to(tests)
        if not path.name.startswith("test_") or file.parts[0] in UNMIRRORED:
            continue
        mirrored = MIRRORED.get(file.parts[0], "")
        module = root / mirrored / Path(*file.parts[1:]).with_name(path.name.removeprefix("test_"))
        mirrors = mirrored and (module.exists() or module.with_suffix("").is_dir())
        if not mirrors and str(file) not in named:
            strays.append(str(file))
    assert not strays, "mirror no module and stand in no table of tests/README.md: " + ", ".join(strays)


def test_every_test_file_that_the_readme_of_the_tests_names_exists(root: Path) -> None:
    named = named_in_the_readme(root)
    assert named
    assert [file for file in named if not (root / "tests" / file).is_file()] == []
