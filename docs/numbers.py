"""Numbers of pages, looked up in the results of studies and benchmarks.

A template in `docs/templates/` has places such as `{missions:scenarios/default/successes}`: the name of a JSON file in
`experiments/results/` or `benchmarks/results/`, and the path of a value in it. A form may follow: `|cm.2` is a length
in metres, shown in centimetres with two digits, and with its interval if it has one; `!` at the end of the form leaves
out unit and interval. Below each table stands with which version and commit its numbers were made.

A line that begins with `?` is left out as long as one of its numbers has not been measured: then there is no file or no
value.
"""

import json
import re
from functools import cache
from pathlib import Path
from textwrap import fill
from typing import Any, Final

DOCS: Final = Path(__file__).parent
TEMPLATES: Final = DOCS / "templates"
RESULTS: Final = tuple(DOCS.parent / folder / "results" for folder in ("experiments", "benchmarks"))
UNITS: Final = {
    "cm": (100.0, " cm"),
    "m": (1.0, " m"),
    "deg": (1.0, "°"),
    "s": (1.0, " s"),
    "ms": (1.0, " ms"),
    "percent": (100.0, " %"),
    "x": (1.0, ""),
}
"""Factor and text of each unit; `ms` is of values in milliseconds."""
NO_VALUE: Final = "-"
"""Shown where nothing could be measured: the value is null."""
WIDTH: Final = 120
IF_MEASURED: Final = "? "
"""Begins a line that is left out without its numbers."""
_PLACE: Final = re.compile(r"\{(?P<source>\w+):(?P<path>[^|}]+)(?:\|(?P<unit>\w+)\.(?P<digits>\d)(?P<bare>!?))?\}")


class NumberError(Exception):
    """A place whose number cannot be found or shown; names the place."""


def filled_template(name: str) -> str:
    """Return a template with its numbers, and how these were made.

    Raises:
        NumberError: A number is missing.
    """
    text = measured_lines((TEMPLATES / f"{name}.md").read_text().rstrip())
    return f"{filled_text(text)}\n\n{made_words(sources_of(text))}\n"


def measured_lines(text: str) -> str:
    """Return a text without its lines for numbers that have not been measured, and without the marks of the others."""
    lines = []
    for line in text.splitlines():
        if not line.startswith(IF_MEASURED):
            lines.append(line)
        elif all(map(_is_measured, _PLACE.finditer(line))):
            lines.append(line.removeprefix(IF_MEASURED))
    return "\n".join(lines)


def _is_measured(found: re.Match[str]) -> bool:
    try:
        _found_value(found)
    except NumberError:
        return False
    return True


def filled_text(text: str) -> str:
    """Return a text with its numbers.

    Raises:
        NumberError: A number is missing.
    """
    return _PLACE.sub(_value, text)


def sources_of(text: str) -> list[str]:
    """Name the files of results that a text has numbers of, in the order of the text."""
    return list(dict.fromkeys(found["source"] for found in _PLACE.finditer(text)))


def made_words(sources: list[str]) -> str:
    """Say with which version and commit the numbers of some files were made."""
    made = {name: how for source in sources for name, how in read(source)["made"].items()}
    by_commit: dict[tuple[str, str], list[str]] = {}
    for name, how in made.items():
        by_commit.setdefault((how["version"], how["commit"]), []).append(f"`{name}`")
    parts = [f"{', '.join(names)} with {version}, commit {commit}" for (version, commit), names in by_commit.items()]
    return fill(f"Made: {'; '.join(parts)}.", WIDTH, break_long_words=False, break_on_hyphens=False)


@cache
def read(source: str) -> dict[str, Any]:
    """Read a JSON file of results.

    Raises:
        NumberError: There is none.
    """
    for folder in RESULTS:
        if (file := folder / f"{source}.json").exists():
            found: dict[str, Any] = json.loads(file.read_text())
            return found
    raise NumberError(f"Expected {source}.json in the results of experiments or benchmarks, got none")


def kinds_of(text: str) -> list[str]:
    """Name the kinds of the intervals that a text shows, in its order.

    Raises:
        NumberError: A number is missing.
    """
    shown = (_found_value(found) for found in _PLACE.finditer(text) if found["unit"] and not found["bare"])
    return list(dict.fromkeys(each["kind"] for each in shown if isinstance(each, dict) and each.get("low") is not None))


def _found_value(found: re.Match[str]) -> Any:
    value: Any = read(found["source"])
    for key in found["path"].split("/"):
        try:
            value = value[int(key)] if isinstance(value, list) else value[key]
        except (KeyError, IndexError, TypeError, ValueError) as error:
            raise NumberError(f"{found[0]}: expected a value, got none at {key!r}") from error
    return value


def _value(found: re.Match[str]) -> str:
    value = _found_value(found)
    if value is None:
        return NO_VALUE
    if found["unit"] is None:
        if isinstance(value, dict | list | float):
            raise NumberError(f"{found[0]}: expected a form such as |cm.2 for {value!r}")
        return str(value)
    if found["unit"] not in UNITS:
        raise NumberError(f"{found[0]}: expected a unit among {', '.join(UNITS)}, got {found['unit']}")
    factor, unit = UNITS[found["unit"]]
    return _shown(value, factor, int(found["digits"]), "" if found["bare"] else unit, with_interval=not found["bare"])


def _shown(value: Any, factor: float, n_digits: int, unit: str, *, with_interval: bool) -> str:
    """Return a number, or an estimate with its interval, in a unit."""
    estimate = value if isinstance(value, dict) else {"value": value}
    middle, low, high = estimate["value"], estimate.get("low"), estimate.get("high")
    text = f"{_rounded(factor * middle, n_digits)}{unit}"
    if not with_interval or low is None or high is None:
        return text
    return f"{text} [{_rounded(factor * low, n_digits)}, {_rounded(factor * high, n_digits)}]"


def _rounded(value: float, n_digits: int) -> str:
    """Return a number with these digits; zero has no sign."""
    return f"{round(value, n_digits) + 0.0:.{n_digits}f}"
