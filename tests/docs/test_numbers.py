"""The numbers of the pages are those of the results."""

import re
from pathlib import Path

import pytest

from docs import generate, numbers

NUMBERS = {"made": {"walks": {"version": "0.1.0", "commit": "abcdef0"}}, "n": 3, "names": ["a", "b"]}
NUMBERS |= {
    "error_m": {"value": 0.0123, "low": 0.01, "high": 0.015, "kind": "Student's t 95 %"},
    "worst_m": 0.02,
    "alone": {"value": 2.0},
    "below_zero": -1e-5,
    "nothing": None,
}


@pytest.fixture
def walks(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    """A folder of templates, with a result called `walks`."""
    monkeypatch.setattr(numbers, "read", lambda source: {"walks": NUMBERS}[source])
    monkeypatch.setattr(numbers, "TEMPLATES", tmp_path)
    return tmp_path


def shown(folder: Path, template: str) -> str:
    (folder / "page.md").write_text(template)
    return numbers.filled_template("page").partition("\n")[0]


@pytest.mark.parametrize("page", [generate.MEASURED, generate.README, generate.SCALING], ids=lambda page: page.stem)
def test_the_numbers_of_a_page_are_up_to_date(page: Path) -> None:
    text = page.read_text()

    assert generate.filled(text, generate.measured_parts()) == text, "run `python -m docs.generate`"


def test_the_list_of_studies_is_up_to_date() -> None:
    text = generate.EXPERIMENTS.read_text()

    assert generate.filled(text, generate.experiments_parts()) == text, "run `python -m docs.generate`"


def test_the_reasons_of_endings_are_those_of_the_table() -> None:
    text = generate.RUN.read_text()
    assert "<!-- generated: reasons -->" in text
    assert generate.filled(text, generate.run_parts()) == text, "run `python -m docs.generate`"


def test_every_template_is_a_part_of_a_page() -> None:
    written = (generate.MEASURED, generate.README, generate.PAPER, generate.REALISM, generate.SCALING)
    pages = "".join(page.read_text() for page in written)

    assert sorted(re.findall(r"<!-- generated: (\w+) -->", pages)) == sorted([*generate.TEMPLATES, "claims"])


def test_no_table_of_the_measurements_is_written_by_hand() -> None:
    by_hand = re.sub(r"<!-- generated: \w+ -->.*?<!-- end -->", "", generate.MEASURED.read_text(), flags=re.DOTALL)

    assert "|" not in by_hand


@pytest.mark.parametrize(
    ("place", "text"),
    [
        ("{walks:n}", "3"),
        ("{walks:names/1}", "b"),
        ("{walks:error_m|cm.2}", "1.23 cm [1.00, 1.50]"),
        ("{walks:error_m|cm.1!}", "1.2"),
        ("{walks:worst_m|cm.0}", "2 cm"),
        ("{walks:worst_m|percent.0}", "2 %"),
        ("{walks:alone|x.1}", "2.0"),
        ("{walks:below_zero|x.2}", "0.00"),
        ("{walks:nothing|x.2}", "-"),
    ],
)
def test_a_place_shows_its_number(walks: Path, place: str, text: str) -> None:
    assert shown(walks, place) == text


@pytest.mark.parametrize(
    ("place", "message"),
    [
        ("{walks:m}", "expected a value, got none at 'm'"),
        ("{walks:names/2}", "expected a value, got none at '2'"),
        ("{walks:worst_m}", r"expected a form such as \|cm\.2 for 0\.02"),
        ("{walks:worst_m|inch.1}", "expected a unit among cm, .*, got inch"),
    ],
)
def test_a_place_without_a_number_is_an_error(walks: Path, place: str, message: str) -> None:
    with pytest.raises(numbers.NumberError, match=message):
        shown(walks, place)


@pytest.mark.parametrize(
    ("line", "shown_lines"),
    [
        ("? | {walks:n} |", ["| 3 |"]),
        ("? | {walks:n} | {walks:missing} |", []),
        ("? | {runs:n} |", []),
        ("| {walks:n} |", ["| 3 |"]),
    ],
)
def test_a_line_is_left_out_as_long_as_one_of_its_numbers_has_not_been_measured(
    walks: Path, monkeypatch: pytest.MonkeyPatch, line: str, shown_lines: list[str]
) -> None:
    def read(source: str) -> object:
        if source != "walks":
            raise numbers.NumberError(source)
        return NUMBERS

    monkeypatch.setattr(numbers, "read", read)
    (walks / "page.md").write_text(f"{{walks:n}}\n{line}\n")
    assert numbers.filled_template("page").partition("\n\n")[0].splitlines() == ["3", *shown_lines]


def test_the_kinds_of_intervals_are_those_that_a_text_shows(walks: Path) -> None:
    shown = "{walks:n}, {walks:error_m|cm.2}, {walks:error_m|cm.1}, {walks:worst_m|cm.0}, {walks:alone|x.1}"

    assert numbers.kinds_of(shown) == ["Student's t 95 %"]
    assert numbers.kinds_of("{walks:error_m|cm.2!} and {walks:worst_m|cm.0}") == []


def test_a_source_that_does_not_exist_is_an_error() -> None:
    with pytest.raises(numbers.NumberError, match=r"Expected squares\.json"):
        numbers.read("squares")


def test_a_table_says_with_which_version_and_commit_it_was_made(walks: Path) -> None:
    (walks / "page.md").write_text("{walks:n}\n")

    assert numbers.filled_template("page") == "3\n\nMade: `walks` with 0.1.0, commit abcdef0.\n"
