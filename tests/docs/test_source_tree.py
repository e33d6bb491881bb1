"""The tables of the source tree name every part, in the order of its layer, with what its docstring says."""

import re
from pathlib import Path

import pytest

from docs import generate, source_tree

TEXT = generate.ARCHITECTURE.read_text()


def test_the_generated_parts_of_the_page_are_up_to_date() -> None:
    parts = generate.architecture_parts()

    assert generate.filled(TEXT, parts) == TEXT, "run `python docs/generate.py`"
    assert sorted(re.findall(r"<!-- generated: (\w+) -->", TEXT)) == sorted(parts)


@pytest.mark.parametrize("package", source_tree.FOLDERS)
def test_every_folder_and_module_of_a_package_is_a_part(package: str) -> None:
    folder = source_tree.FOLDERS[package]
    modules = {path.stem for path in folder.glob("*.py")} - {"__init__"}
    folders = {path.parent.name for path in folder.glob("*/__init__.py")}

    assert {part.name for part in source_tree.parts(package)} == modules | folders


def test_a_part_may_import_the_layers_below_its_own() -> None:
    layers = {part.name: part.layer for part in source_tree.parts("planner_proc")}

    assert layers["planning"] > layers["trunk_plan"] == layers["box_plan"] > layers["search"] > layers["clearance"] == 1


def test_a_part_has_the_libraries_that_its_contracts_protect() -> None:
    libraries = {part.name: part.libraries() for part in source_tree.parts("sim_proc")}

    assert libraries["headless"] == ["mujoco"]
    assert libraries["control"] == []


def test_a_rule_names_modules_without_their_package() -> None:
    assert "`history` must not import `bus`" in source_tree.package_table("legpush")
    assert "`planner_proc` and `sim_proc` must not import `torch`, " in source_tree.shared_rules()


def test_the_first_sentence_of_a_docstring_is_one_line(tmp_path: Path) -> None:
    module = tmp_path / "module.py"
    module.write_text('"""Walks (Figs. 1 and 2)\nto the box. Then it\npushes.\n\nMore.\n"""\n')

    assert source_tree.first_sentence(module) == "Walks (Figs. 1 and 2) to the box."


def test_a_module_without_a_docstring_is_an_error(tmp_path: Path) -> None:
    module = tmp_path / "module.py"
    module.write_text("x = 1\n")

    with pytest.raises(ValueError, match=r"Expected a docstring in .*module\.py, got none"):
        source_tree.first_sentence(module)
