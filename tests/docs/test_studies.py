"""The study files on the page about studies can be run."""

import re

import pytest

from docs import generate
from legpush.study.cells import kind_names, load_kind
from legpush.study.file import read_study
from tests.docs.test_pages import CODE

FILES = [text for language, text in CODE.findall((generate.DOCS / "studies.md").read_text()) if language == "toml"]


def test_the_page_has_study_files() -> None:
    assert len(FILES) >= 2


@pytest.mark.parametrize("text", FILES, ids=lambda text: re.findall('name = "(.*)"', text)[0])
def test_every_cell_of_a_study_on_the_page_can_be_resolved(text: str) -> None:
    study = read_study(text, "studies.md")
    cells = {task.cell for task in study.tasks()}
    assert len(cells) == study.n_cells > 100


def test_the_kinds_on_the_page_are_the_installed_ones_with_their_fields() -> None:
    rows = re.findall(r"^\| `(\w+)` \| [^|]* \| (.*) \|$", (generate.DOCS / "studies.md").read_text(), re.MULTILINE)
    fields = {kind: set(re.findall(r"`(\w+)`", text)) - {"trunk", "box"} for kind, text in rows}
    assert {kind: fields[kind] for kind in kind_names()} == {
        kind: set(load_kind(kind).specification.__struct_fields__) - {"changes"} for kind in kind_names()
    }
