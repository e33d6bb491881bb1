"""The page about learning has the tasks and terms of the code, and its task file can be learned."""

import re
from pathlib import Path

import pytest

from agent_proc.profiles.profile import load_profile
from agent_proc.studies.tuning.space import load_space
from agent_proc.task.file import load_task, task_names
from agent_proc.task.terms import OWN
from docs import environment_tables, generate, term_tables
from tests.docs.test_pages import CODE

TEXT = generate.LEARN.read_text()
TOML = [text for language, text in CODE.findall(TEXT) if language == "toml" and "entry-points" not in text]
FILES = [text for text in TOML if "[search" not in text]
SPACES = [text for text in TOML if text not in FILES]


def test_the_generated_parts_of_the_page_are_up_to_date() -> None:
    parts = term_tables.learn_parts()

    assert generate.filled(TEXT, parts) == TEXT, "run `python -m docs.generate`"
    assert sorted(re.findall(r"<!-- generated: (\w+) -->", TEXT)) == sorted(parts)


def test_every_task_and_every_term_is_in_a_table() -> None:
    tables = "\n".join(term_tables.learn_parts().values())

    assert all(f"| `{name}` |" in tables for name in (*task_names(), *OWN))


def test_the_page_of_the_environments_is_up_to_date_and_every_element_has_one_unit() -> None:
    parts = environment_tables.environment_parts()
    page = generate.ENVIRONMENT.read_text()
    rows = re.findall(r"^\| \d+ \| `(.+?)` \| (.*?) \|", parts["environment_tasks"], re.MULTILINE)

    assert generate.filled(page, parts) == page, "run `python -m docs.generate`"
    assert [name for name, unit in rows if "," in unit] == []
    assert {unit for name, unit in rows if name == "drift.turn"} == {"rad"}


@pytest.mark.parametrize("text", FILES)
def test_the_task_files_on_the_page_can_be_loaded(tmp_path: Path, text: str) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(text)

    assert load_task(str(path)).description


@pytest.mark.parametrize("text", SPACES)
def test_the_search_spaces_on_the_page_can_be_loaded(tmp_path: Path, text: str) -> None:
    path = tmp_path / "space.toml"
    path.write_text(text)

    assert load_space(str(path), load_profile("tuned"))
