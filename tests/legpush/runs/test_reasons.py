"""The reasons of endings: each has a meaning, and names what would change it."""

import re
from dataclasses import fields
from functools import reduce
from typing import get_args

import pytest

from legpush.options.run import RunOptions
from legpush.runs.reasons import REASONS, Reason
from legpush.scenarios.file import load_scenario

SCENARIO = load_scenario("default")
OPTIONS = {f"--{field.name.replace('_', '-')}" for field in fields(RunOptions)}


def test_each_reason_is_in_the_table_once() -> None:
    assert tuple(REASONS) == get_args(Reason)


@pytest.mark.parametrize("reason", REASONS)
def test_the_remedy_of_a_reason_names_keys_that_exist(reason: Reason) -> None:
    note = REASONS[reason]
    assert note.meaning.endswith(".")
    assert bool(note.remedy) == bool(note.keys) == (reason != "success")
    for key in note.keys:
        assert f"`{key}`" in note.remedy
        if key.startswith("--"):
            assert key in OPTIONS
        else:
            reduce(getattr, key.split("."), SCENARIO)
    named = re.findall(r"`([^` ]+)`", note.remedy)
    assert set(named) == set(note.keys)
