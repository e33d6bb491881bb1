"""The endings of missions: wherever one is raised, its reason is in the table, and its remedy names keys that exist."""

import ast
import re
from dataclasses import fields
from functools import reduce
from pathlib import Path

import pytest

import agent_proc
from agent_proc.endings import REASON_OF, MissionEndedError
from legpush.errors import DivergedError, LegpushError, PeerError
from legpush.options.run import RunOptions
from legpush.runs.reasons import ENDED_BY_ERROR, REASONS
from legpush.scenarios.file import load_scenario

SOURCE = Path(agent_proc.__file__).parent
SCENARIO = load_scenario("default")
OPTIONS = {f"--{field.name.replace('_', '-')}" for field in fields(RunOptions)}
CALLS = [
    (f"{path.name}:{node.lineno}", node)
    for path in sorted(SOURCE.rglob("*.py"))
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "MissionEndedError"
]


def texts(node: ast.AST) -> str:
    """All text in an expression, with names for what is filled in."""
    constants = (part.value for part in ast.walk(node) if isinstance(part, ast.Constant))
    return "".join(value for value in constants if isinstance(value, str))


def test_endings_are_raised_in_many_places() -> None:
    assert len(CALLS) >= 10


@pytest.mark.parametrize(("where", "call"), CALLS, ids=[where for where, _ in CALLS])
def test_each_ending_has_a_reason_of_the_table_and_names_keys(where: str, call: ast.Call) -> None:
    reason = call.args[0]
    if isinstance(reason, ast.Constant):
        assert reason.value in REASONS, where
    if len(call.args) > 2 and isinstance(call.args[2], ast.Constant | ast.JoinedStr):
        named = re.findall(r"`([^` ]+)`", texts(call.args[2]))
        assert named, where
        for key in named:
            assert key in OPTIONS or reduce(getattr, key.split("."), SCENARIO) is not SCENARIO


def test_without_a_remedy_of_its_own_an_ending_has_that_of_its_reason() -> None:
    for reason, note in REASONS.items():
        assert MissionEndedError(reason, "").remedy == note.remedy
    assert MissionEndedError("stuck", "", "another one").remedy == "another one"


def test_errors_that_a_second_try_meets_again_have_exit_code_2_and_others_are_no_endings() -> None:
    assert set(REASON_OF.values()) == set(ENDED_BY_ERROR)
    assert {kind.exit_code for kind in REASON_OF} == {2}
    for kind in (PeerError, DivergedError, LegpushError):
        assert not issubclass(kind, tuple(REASON_OF))
