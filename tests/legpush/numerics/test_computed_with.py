"""Other versions and other numerics are told as what they are."""

import pytest

from legpush.errors import DivergedError, OtherVersionError
from legpush.numerics.computed_with import NUMERICS, ComputedWith, computed_with, told
from legpush.numerics.current import current
from legpush.numerics.motion_version import MOTION_VERSION, MOTIONS

HERE = ComputedWith(str(MOTION_VERSION), current().name)
DIFFERENCE = DivergedError("Expected state 1, got 2")


def test_the_same_is_no_other() -> None:
    assert HERE.other_version() == ""
    assert HERE.other_numerics(current().name) == ""
    assert told(DIFFERENCE, HERE, "unused") is DIFFERENCE


@pytest.mark.parametrize(
    ("numerics", "words"),
    [
        ("native/2", "other numerics: recorded with native/2, here x86-64-v3/1"),
        (None, "other numerics: recorded with numerics that were not noted, here x86-64-v3/1"),
    ],
)
def test_other_numerics_are_told_apart_from_none_that_were_noted(numerics: str | None, words: str) -> None:
    assert HERE._replace(numerics=numerics).other_numerics("x86-64-v3/1") == words
    error = told(DIFFERENCE, HERE._replace(numerics=numerics), "unused")
    assert type(error) is DivergedError
    assert str(error).startswith("other numerics: ")
    assert str(error).endswith("; Expected state 1, got 2")


@pytest.mark.parametrize(
    ("motions", "words"),
    [
        ("1", f"other version: recorded with motion version 1, here {MOTION_VERSION}"),
        ("99", f"other version: recorded with motion version 99, here {MOTION_VERSION}"),
        (None, f"other version: recorded before motions had a version, here {MOTION_VERSION}"),
    ],
)
@pytest.mark.parametrize("numerics", [None, "native/2", current().name])
def test_another_version_is_all_that_is_told(motions: str | None, words: str, numerics: str | None) -> None:
    error = told(DIFFERENCE, ComputedWith(motions, numerics), "it can be shown")
    assert isinstance(error, OtherVersionError)
    assert (str(error), error.exit_code) == (f"{words}; it can be shown", 2)


def test_it_is_read_from_versions_of_any_age() -> None:
    assert computed_with({"numpy": "2.4.6"}) == ComputedWith(None, None)
    assert computed_with({NUMERICS: "native/2", MOTIONS: "5"}) == ComputedWith("5", "native/2")
