"""Types of fields for messages, files and command lines, and checks of values on a command line."""

import re
from typing import Annotated, Any, Final

import msgspec
from msgspec import Meta, inspect

from legpush.errors import ConfigError

SEEDS: Final = 2**32
"""Number of seeds; the highest is one less."""

MOST_SEEDS: Final = 10_000
"""Most seeds of a range on a command line."""

MAX_NAME: Final = 64
"""Most characters of a name."""

Name = Annotated[str, Meta(pattern=rf"^[A-Za-z0-9_-]{{1,{MAX_NAME}}}$(?!\n)")]
"""A part of keys on the bus, and of file names."""
Seed = Annotated[int, Meta(ge=0, le=SEEDS - 1)]
"""Seed of a random generator."""

_EXPECTED: Final = {
    Name: f"Expected 1 to {MAX_NAME} letters, digits, - or _",
    Seed: f"Expected a seed from 0 to {SEEDS - 1}",
}


def require(kind: Any, value: object, flag: str, unit: str = "") -> None:
    """Check the value of a flag, unless it is None, against its type: `Name`, `Seed` or a number of `legpush.bounds`.

    Raises:
        ConfigError: The value does not fit; names the flag and what is valid.
    """
    try:
        if value is not None:
            msgspec.convert(value, kind)
    except msgspec.ValidationError as error:
        expected = _EXPECTED.get(kind) or f"Expected {range_of(inspect.type_info(kind))}{unit and f' {unit}'}"
        raise ConfigError(f"{expected} for {flag}, got {value!r}") from error


def range_of(number: inspect.Type) -> str | None:
    """Return the range of a number as a text, such as `0 to 1`; None if this is no number that has both bounds."""
    if not isinstance(number, inspect.IntType | inspect.FloatType) or None in (number.ge, number.le):
        return None
    return " to ".join(str(end) if isinstance(end, int) else f"{end:g}" for end in (number.ge, number.le))


def require_seeds(first: int, n: int, flag: str) -> None:
    """Check that `n` seeds from `first` on exist.

    Raises:
        ConfigError: One of them is out of range.
    """
    if not 0 <= first <= SEEDS - n:
        raise ConfigError(f"Expected seeds from 0 to {SEEDS - 1}, got {n} from {flag} {first} on")


def parse_seeds(text: str, flag: str) -> tuple[int, ...]:
    """Parse a list of seeds and ranges of seeds, such as `1-5` or `1,3,7-9`, in its order.

    Raises:
        ConfigError: The text has another form, a range does not rise, or a seed is given twice; names the flag.
    """
    seeds: list[int] = []
    for part in text.split(","):
        if (found := re.fullmatch(r"(\d{1,10})(?:-(\d{1,10}))?", part.strip(), re.ASCII)) is None:
            raise ConfigError(f"Expected seeds such as 1-5 or 1,3,7 for {flag}, got {text!r}")
        first, last = int(found[1]), int(found[2] or found[1])
        if not first <= last < SEEDS or last - first >= MOST_SEEDS:
            raise ConfigError(
                f"Expected rising ranges of at most {MOST_SEEDS} seeds from 0 to {SEEDS - 1} for {flag}, got {part}"
            )
        seeds += range(first, last + 1)
    if len(set(seeds)) < len(seeds):
        raise ConfigError(f"Expected each seed once for {flag}, got {text}")
    return tuple(seeds)


def episode_and_step(text: str, flag: str) -> tuple[int, int]:
    """Parse the place of a step in a recording: `EPISODE:STEP`.

    Raises:
        ConfigError: The text has another form; names the flag.
    """
    if re.fullmatch(r"\d+:\d+", text) is None:
        raise ConfigError(f"Expected EPISODE:STEP for {flag}, such as 0:12, got {text!r}; `legpush info` lists both")
    episode, step = map(int, text.split(":"))
    return episode, step
