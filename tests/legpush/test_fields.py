"""Names, seeds and places of steps: what is taken, and what is refused with its flag."""

from math import inf, nan, nextafter
from typing import Annotated

import pytest
from msgspec import Meta, inspect

from legpush.bounds import BoxMass, Count
from legpush.errors import ConfigError
from legpush.fields import SEEDS, Name, Seed, episode_and_step, parse_seeds, range_of, require, require_seeds


@pytest.mark.parametrize(("kind", "value"), [(Name, "a"), (Name, "A-b_9" * 12), (Seed, 0), (Seed, SEEDS - 1)])
def test_what_fits_is_taken(kind: object, value: object) -> None:
    require(kind, value, "--flag")


@pytest.mark.parametrize("value", ["", "a b", "a\n", "x" * 65, "a/b", "*"])
def test_a_name_that_could_not_be_part_of_a_key_is_refused(value: str) -> None:
    with pytest.raises(ConfigError, match="Expected 1 to 64 letters, digits, - or _ for --name, got "):
        require(Name, value, "--name")


@pytest.mark.parametrize("value", [-1, SEEDS])
def test_a_seed_out_of_range_is_refused(value: int) -> None:
    with pytest.raises(ConfigError, match=f"Expected a seed from 0 to 4294967295 for --seed, got {value}"):
        require(Seed, value, "--seed")


@pytest.mark.parametrize("value", [nan, inf, -inf, 1e308, -1.0, nextafter(0.001, 0.0), nextafter(1000.0, inf), 10**308])
def test_a_number_out_of_its_range_is_refused_with_the_range(value: float) -> None:
    with pytest.raises(ConfigError, match=r"Expected 0\.001 to 1000 kg for --mass, got "):
        require(BoxMass, value, "--mass", "kg")


def test_a_number_in_its_range_and_none_are_taken() -> None:
    for value in (0.001, 1000.0, 1, None):
        require(BoxMass, value, "--mass")


def test_a_range_has_both_ends() -> None:
    assert range_of(inspect.type_info(Count)) == "0 to 9007199254740992"
    assert range_of(inspect.type_info(BoxMass)) == "0.001 to 1000"
    for kind in (float, str, Annotated[float, Meta(ge=0.0)], Annotated[int, Meta(le=3)]):
        assert range_of(inspect.type_info(kind)) is None


def test_a_row_of_seeds_has_to_end_before_the_seeds_do() -> None:
    require_seeds(SEEDS - 3, 3, "--first-seed")
    with pytest.raises(ConfigError, match="got 4 from --first-seed 4294967293 on"):
        require_seeds(SEEDS - 3, 4, "--first-seed")
    with pytest.raises(ConfigError, match="got 1 from --first-seed -1 on"):
        require_seeds(-1, 1, "--first-seed")


def test_the_place_of_a_step_is_two_numbers() -> None:
    assert episode_and_step("0:12", "--at") == (0, 12)


@pytest.mark.parametrize("text", ["", "3", "0:", "0:-1", "a:1", "0:1:2"])
def test_a_place_that_is_something_else_is_refused(text: str) -> None:
    with pytest.raises(ConfigError, match=f"Expected EPISODE:STEP for --at, such as 0:12, got '{text}'; "):
        episode_and_step(text, "--at")


def test_seeds_are_numbers_and_rising_ranges() -> None:
    assert parse_seeds("1-3", "--seeds") == (1, 2, 3)
    assert parse_seeds("9,4 , 6-6", "--seeds") == (9, 4, 6)


@pytest.mark.parametrize(
    ("text", "match"),
    [
        ("", "Expected seeds such as 1-5 or 1,3,7 for --seeds, got ''"),
        ("1-", "Expected seeds such as"),
        ("-1", "Expected seeds such as"),
        ("5-1", "Expected rising ranges of at most 10000 seeds from 0 to 4294967295 for --seeds, got 5-1"),
        ("4294967296", "Expected rising ranges"),
        ("0-10000", "Expected rising ranges"),
        ("1-3,2", "Expected each seed once for --seeds, got 1-3,2"),
    ],
)
def test_seeds_that_are_none_are_refused(text: str, match: str) -> None:
    with pytest.raises(ConfigError, match=match):
        parse_seeds(text, "--seeds")
