"""The table of the paper's claims in `paper.md`, from `experiments/paper/claims.toml`.

Each claim says which figures, tables and equations it covers, what the paper says, what is found here, where, and a
verdict. Our numbers are places as in the templates of `numbers.py`. What a claim names as its evidence must exist: a
file of the repository, a study, or a command.
"""

import importlib.util
import shlex
from pathlib import Path
from typing import Annotated, Final, Literal, get_args

import msgspec
from msgspec import Meta, Struct

from docs import numbers, study_list

ROOT: Final = Path(__file__).parents[1]
CLAIMS: Final = ROOT / "experiments" / "paper" / "claims.toml"
TO_ROOT: Final = "../"
"""From the page to the root of the repository."""
Verdict = Literal[
    "reproduced", "reproduced with a correction", "better", "added", "differs", "not reproduced", "not attempted"
]
MEANINGS: Final[dict[Verdict, str]] = {
    "reproduced": "the same method or the same finding",
    "reproduced with a correction": "the same, after an error in the printed text is corrected; the row names it",
    "better": "measured as in the paper, and the result is better; the row has both numbers",
    "added": "the paper leaves it for later or gives no number; it is measured here",
    "differs": "done in another way, or another result was measured; the row says which",
    "not reproduced": "tried; the paper's finding did not come out",
    "not attempted": "the row says why",
}
Text = Annotated[str, Meta(min_length=1)]
_NO_EVIDENCE_NEEDED: Final = ("not attempted",)


class ClaimError(Exception):
    """A claim that cannot be shown; names it."""


class Claim(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """One claim of the paper."""

    part: Text
    """Heading of the table that has it."""
    covers: Annotated[tuple[Text, ...], Meta(min_length=1)]
    """Where the paper makes it: figures, tables, equations and sections, such as `Fig. 16` or `5.3`."""
    says: Text
    """What the paper says."""
    n: Annotated[int, Meta(ge=1)] | None = None
    """Number of runs behind a published number, if the paper has one."""
    here: Text
    """What is found here; numbers are places such as `{circles:n}`."""
    where: tuple[Text, ...] = ()
    """Files, `study NAME`, or commands that begin with `python -m` or `legpush`."""
    verdict: Verdict

    @property
    def name(self) -> str:
        """What to call it in an error message."""
        return f"claim {', '.join(self.covers)}"


class Claims(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """All claims, in the order of the page."""

    claim: Annotated[tuple[Claim, ...], Meta(min_length=1)]


def read_claims(path: Path = CLAIMS) -> tuple[Claim, ...]:
    """Read and check the claims.

    Raises:
        ClaimError: The file is not valid, or a claim lacks its evidence.
    """
    try:
        claims = msgspec.toml.decode(path.read_text(), type=Claims).claim
    except msgspec.MsgspecError as error:
        raise ClaimError(f"{path}: {error}") from error
    for claim in claims:
        _require_evidence(claim)
    return claims


def _require_evidence(claim: Claim) -> None:
    if not claim.where and claim.verdict not in _NO_EVIDENCE_NEEDED:
        raise ClaimError(f"{claim.name}: expected evidence in `where` for the verdict {claim.verdict!r}, got none")
    if claim.verdict == "better" and (claim.n is None or not numbers.sources_of(claim.here)):
        raise ClaimError(f"{claim.name}: expected the published n and a number here for the verdict 'better'")


def parts(path: Path = CLAIMS) -> dict[str, str]:
    """Return the generated part of the page.

    Raises:
        ClaimError: A claim cannot be shown.
        NumberError: A number is missing.
    """
    claims = read_claims(path)
    by_part: dict[str, list[str]] = {}
    for claim in claims:
        by_part.setdefault(claim.part, []).append(_row(claim))
    blocks = [_verdict_table(claims)]
    head = ["| paper | it says | here | verdict | where |", "| --- | --- | --- | --- | --- |"]
    blocks += ["\n".join([f"### {part}", "", *head, *rows]) for part, rows in by_part.items()]
    sources = list(dict.fromkeys(source for claim in claims for source in numbers.sources_of(claim.here)))
    return {"claims": "\n\n".join([*blocks, numbers.made_words(sources)]) + "\n"}


def _verdict_table(claims: tuple[Claim, ...]) -> str:
    counts = {verdict: sum(claim.verdict == verdict for claim in claims) for verdict in get_args(Verdict)}
    rows = [f"| {verdict} | {counts[verdict]} | {MEANINGS[verdict]} |" for verdict in counts]
    return "\n".join(["| verdict | rows | meaning |", "| --- | --- | --- |", *rows])


def _row(claim: Claim) -> str:
    says = claim.says if claim.n is None else f"{claim.says} (n {claim.n})"
    try:
        here, kinds = numbers.filled_text(claim.here), numbers.kinds_of(claim.here)
    except numbers.NumberError as error:
        raise ClaimError(f"{claim.name}: {error}") from error
    here += f". Intervals: {', '.join(kinds)}" if kinds else ""
    where = ", ".join(_shown_place(claim, place) for place in claim.where)
    cells = (", ".join(claim.covers), says, here, claim.verdict, where or "-")
    return f"| {' | '.join(' '.join(cell.split()) for cell in cells)} |"


def _shown_place(claim: Claim, place: str) -> str:
    """Return a place as a link or as code.

    Raises:
        ClaimError: It does not exist.
    """
    if place.startswith("study "):
        name = place.removeprefix("study ")
        for folder in study_list.FOLDERS:
            if (ROOT / folder / f"{name}.toml").exists():
                return f"study [{name}]({TO_ROOT}{folder}/{name}.toml)"
    elif place.startswith("python -m "):
        if _is_program(shlex.split(place)[2]):
            return f"`{place}`"
    elif place.startswith("legpush "):
        return f"`{place}`"
    elif (ROOT / place).exists():
        return f"[{Path(place).name}]({TO_ROOT}{place})"
    raise ClaimError(f"{claim.name}: expected a file, a study or a command that exists, got {place!r}")


def _is_program(module: str) -> bool:
    """Whether `python -m` can run a module of the repository."""
    try:
        found = importlib.util.find_spec(module)
        if found is not None and found.submodule_search_locations:
            found = importlib.util.find_spec(f"{module}.__main__")
    except ModuleNotFoundError:
        return False
    return found is not None and found.origin is not None
