"""Every figure, table and equation of the paper has a claim, and each claim has its evidence."""

import re
from pathlib import Path

import pytest

from docs import claims, generate, numbers
from tests.command_names import command_names

N_FIGURES, N_TABLES, N_EQUATIONS = 21, 4, 21
CLAIM = """
[[claim]]
part = "Results"
covers = ["Fig. 1"]
says = "A finding"
here = "{here}"
where = {where}
verdict = "{verdict}"
"""


@pytest.fixture(scope="module")
def covered() -> list[str]:
    """What the claims cover."""
    return [place for claim in claims.read_claims() for place in claim.covers]


def written(folder: Path, here: str = "The same", where: str = '["README.md"]', verdict: str = "reproduced") -> Path:
    """A file with one claim."""
    path = folder / "claims.toml"
    path.write_text(CLAIM.format(here=here, where=where, verdict=verdict))
    return path


def test_the_claims_of_the_page_are_up_to_date() -> None:
    text = generate.PAPER.read_text()

    assert generate.filled(text, generate.measured_parts() | claims.parts()) == text, "run `python -m docs.generate`"


@pytest.mark.parametrize(
    ("kind", "n"), [("Fig.", N_FIGURES), ("Table", N_TABLES), ("Eq.", N_EQUATIONS), ("Algorithm", 1)]
)
def test_every_figure_table_and_equation_is_in_one_row(covered: list[str], kind: str, n: int) -> None:
    found = sorted(int(place.split()[1]) for place in covered if place.startswith(f"{kind} "))

    assert found == list(range(1, n + 1))


def test_no_place_of_the_paper_is_in_two_rows(covered: list[str]) -> None:
    assert len(set(covered)) == len(covered)


def test_every_section_with_a_result_has_a_row(covered: list[str]) -> None:
    sections = {place.partition(" ")[0] for place in covered}

    assert {"Abstract", "5.1", "5.2", "5.2.1", "5.2.2", "5.3", "5.4", "5.5", "5.6", "6", "7"} <= sections


def test_the_commands_that_claims_name_exist() -> None:
    named = [place for claim in claims.read_claims() for place in claim.where if place.startswith("legpush ")]

    assert named
    assert {place.split()[1] for place in named} <= set(command_names())


def test_each_verdict_but_the_last_has_a_test_a_study_a_program_or_a_result() -> None:
    kinds = re.compile(r"study |python -m |legpush |tests/.*test_\w+\.py$|experiments/results/")
    without = [
        claim.name
        for claim in claims.read_claims()
        if claim.verdict != "not attempted" and not any(kinds.match(place) for place in claim.where)
    ]

    assert without == []


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"verdict": "proven"}, "Invalid enum value 'proven'"),
        ({"where": "[]"}, "claim Fig. 1: expected evidence in `where` for the verdict 'reproduced', got none"),
        ({"verdict": "better"}, "claim Fig. 1: expected the published n and a number here"),
        ({"where": '["no/such_file.py"]'}, "claim Fig. 1: expected a file, a study or a command that exists"),
        ({"where": '["study squares"]'}, "got 'study squares'"),
        ({"where": '["python -m experiments.squares"]'}, "got 'python -m experiments.squares'"),
        ({"here": "{circles:squares|cm.1}"}, "claim Fig. 1: .*expected a value, got none at 'squares'"),
    ],
)
def test_a_claim_without_its_evidence_is_an_error(tmp_path: Path, changes: dict[str, str], message: str) -> None:
    with pytest.raises(claims.ClaimError, match=message):
        claims.parts(written(tmp_path, **changes))


def test_what_was_not_attempted_needs_no_evidence(tmp_path: Path) -> None:
    part = claims.parts(written(tmp_path, where="[]", verdict="not attempted"))["claims"]

    assert "| Fig. 1 | A finding | The same | not attempted | - |" in part


def test_a_row_shows_the_number_of_the_results_and_links_its_evidence(tmp_path: Path) -> None:
    path = written(tmp_path, here="{circles:n} circles", where='["study circles", "docs/claims.py"]')

    part = claims.parts(path)["claims"]

    n = numbers.read("circles")["n"]
    links = "study [circles](../experiments/studies/circles.toml), [claims.py](../docs/claims.py)"
    assert f"| Fig. 1 | A finding | {n} circles | reproduced | {links} |" in part
    assert "| reproduced | 1 | the same method or the same finding |" in part
    assert "Made: `circles`" in part
