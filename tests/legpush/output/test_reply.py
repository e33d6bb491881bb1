"""Replies of commands: lines for people, or one document for programs."""

import json
import sys
from pathlib import Path

import numpy as np
import pytest

from legpush.arguments import OutputOptions
from legpush.output.reply import document, encode, replying


@pytest.mark.parametrize(
    ("options", "out", "err"),
    [
        (OutputOptions(), "baked\n", ""),
        (OutputOptions(quiet=True), "", ""),
        (OutputOptions(json=True), '{\n  "cakes": 3\n}\n', "baked\n"),
        (OutputOptions(json=True, quiet=True), '{\n  "cakes": 3\n}\n', ""),
    ],
    ids=str,
)
def test_a_command_replies_as_it_was_asked_to(
    options: OutputOptions, out: str, err: str, capsys: pytest.CaptureFixture[str]
) -> None:
    before = sys.stdout
    with replying(options):
        sys.stdout.write("baked\n")
        document({"cakes": 2})
        document({"cakes": 3})
    assert capsys.readouterr() == (out, err)
    assert sys.stdout is before


def test_an_error_leaves_no_document_unless_there_is_one(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(ValueError, match="burnt"), replying(OutputOptions(json=True)):
        raise ValueError("burnt")
    assert capsys.readouterr().out == ""


def test_paths_and_numbers_of_numpy_are_plain_and_what_is_not_finite_is_null() -> None:
    value = {"file": Path("a/b"), "mean": np.float64(0.5), "all": np.array([1.0, 2.0]), "worst": float("nan")}
    assert json.loads(encode(value)) == {"file": "a/b", "mean": 0.5, "all": [1.0, 2.0], "worst": None}
    with pytest.raises(TypeError, match="got object"):
        encode(object())
