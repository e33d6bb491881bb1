"""A missing learning library is named together with the extra that installs it."""

import importlib

import pytest

from agent_proc.policies.learning_libraries import learning_libraries
from legpush.errors import PolicyError


def test_a_missing_library_is_named_with_its_extra() -> None:
    with (
        pytest.raises(PolicyError, match=r"libraries for a training, but no_such_torch is not .*'legpush\[train\]'"),
        learning_libraries("a training"),
    ):
        importlib.import_module("no_such_torch")


def test_other_errors_are_left_as_they_are() -> None:
    with pytest.raises(ImportError, match="broken"), learning_libraries("a training"):
        raise ImportError("broken")
