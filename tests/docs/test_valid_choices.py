"""What a help names as valid is what there is: tasks, profiles and policies are found where they lie."""

import ast

import pytest

from agent_proc.profiles.profile import profile_names
from agent_proc.rivals.registry import RIVALS
from agent_proc.task.file import task_names
from docs.field_texts import texts_below, tree_of
from docs.numbers import DOCS
from legpush.options.learning import EvaluateOptions, TrainOptions
from legpush.options.learning_tools import CompareOptions
from legpush.options.run import RunOptions
from legpush.plugins import plugin_names
from legpush.policy_names import CODED, GROUP


def help_of(options: type, field: str) -> str:
    (definition,) = tree_of(options).body
    assert isinstance(definition, ast.ClassDef)
    return {names[-1]: text for names, text in texts_below(definition.body)}[field]


@pytest.mark.parametrize(
    ("options", "field", "names"),
    [
        (TrainOptions, "task", task_names()),
        (TrainOptions, "profile", profile_names()),
        (EvaluateOptions, "policy", CODED),
        (RunOptions, "policy", CODED),
    ],
)
def test_a_help_names_all_choices(options: type, field: str, names: tuple[str, ...]) -> None:
    text = help_of(options, field)
    assert [name for name in names if name not in text] == []


def test_the_help_of_a_comparison_names_all_rivals() -> None:
    text = ast.get_docstring(tree_of(CompareOptions).body[0])  # type: ignore[arg-type]
    assert text is not None
    assert [name for name in RIVALS if name not in text] == []


@pytest.mark.parametrize("page", ["environment", "python", "learn"])
def test_a_page_that_lists_simulators_names_all_of_them(page: str) -> None:
    text = (DOCS / f"{page}.md").read_text()
    assert [
        name for name in plugin_names("legpush.simulators") if f"`{name}`" not in text.replace("--world ", "")
    ] == []


def test_coded_policies_are_plug_ins() -> None:
    assert set(CODED) <= set(plugin_names(GROUP))
