"""Options of `legpush bench soak` that do not go together, or are out of range, are refused with the flag."""

from typing import Any

import pytest

from legpush.errors import ConfigError
from legpush.options.bench import SoakOptions


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"repeat": 0}, "--repeat"),
        ({"steps": 0}, "--steps"),
        ({"steps": 10**12}, "--steps"),
        ({"training": 0.0}, "--training"),
        ({"training": float("nan")}, "--training"),
        ({"seed": -1}, "--seed"),
        ({"table": False}, "--no-table"),
        ({"table": False, "steps": 5, "cells": ("kill",)}, "--no-table"),
    ],
)
def test_what_cannot_be_done_is_refused(options: dict[str, Any], words: str) -> None:
    with pytest.raises(ConfigError, match=words):
        SoakOptions(**options)


def test_usual_ones_are_taken() -> None:
    assert SoakOptions().table
    assert SoakOptions(table=False, steps=10).steps == 10
