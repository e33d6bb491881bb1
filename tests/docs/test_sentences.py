"""Pages, docstrings, comments, messages and help texts are in plain English, without the signs of a riddle."""

import ast
import re
import tokenize
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.docs.help_texts import help_texts

ROOT = Path(__file__).parents[2]
PACKAGES = ("shared/legpush", "sim_proc", "planner_proc", "agent_proc")
FOLDERS = ("docs", "examples", "benchmarks", "experiments")
FILES = ("README.md", "SECURITY.md", "CHANGELOG.md", "Dockerfile", "Makefile", "compose.yaml", "pyproject.toml")
SIGNS = [
    re.compile(sign, re.IGNORECASE)
    for sign in (
        r"\bwhoever\b",
        r"\bwhom(ever)?\b",
        r"\banew\b",
        # A riddle: "waits so long at most". Plain English: "so long that it gives up".
        r"\bso (many|much|long|often)\b(?!( [\w-]+){0,3} (that|as)\b)",
        r"(^|[.,;:!?(] ?)so far\b",
        r"\bthat it has\b",
        r"\bwhere there (is|are) none\b",
        r"\bwhat there is\b",
        r"\bcan be told\b",
    )
]


def signs(text: str) -> list[str]:
    """The signs of a riddle in a text, each with some words around it."""
    flat = " ".join(text.split())
    return [flat[max(0, found.start() - 40) : found.end() + 40] for sign in SIGNS for found in sign.finditer(flat)]


def words_of(file: Path) -> Iterator[tuple[int, str]]:
    """Line and text of each string, docstrings included, and of each block of comments in a Python file."""
    tree = ast.parse(file.read_text())
    pieces = {id(piece) for node in ast.walk(tree) if isinstance(node, ast.JoinedStr) for piece in node.values}
    for node in ast.walk(tree):
        if isinstance(node, ast.JoinedStr):
            yield node.lineno, "".join(str(piece.value) for piece in node.values if isinstance(piece, ast.Constant))
        elif isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in pieces:
            yield node.lineno, node.value
    block: list[str] = []
    first = last = 0
    with file.open("rb") as source:
        comments = [token for token in tokenize.tokenize(source.readline) if token.type == tokenize.COMMENT]
    for token in comments:
        if block and token.start[0] > last + 1:
            yield first, " ".join(block)
            block = []
        first = first if block else token.start[0]
        last = token.start[0]
        block.append(token.string.removeprefix("#").strip())
    if block:
        yield first, " ".join(block)


def texts_in(folder: Path) -> Iterator[tuple[str, str]]:
    """Place and text of everything that the files of a folder say to people."""
    for file in sorted(folder.rglob("*")):
        if file.suffix == ".py":
            for line, text in words_of(file):
                yield f"{file.relative_to(ROOT)}:{line}", text
        elif file.name == "architecture.md":
            # What is generated here is checked in the module that it comes from.
            yield (
                str(file.relative_to(ROOT)),
                re.sub(r"<!-- generated.*?<!-- end", "", file.read_text(), flags=re.DOTALL),
            )
        elif file.suffix in (".md", ".toml", ".yaml", ".cjs"):
            yield str(file.relative_to(ROOT)), file.read_text()


def riddles(texts: Iterator[tuple[str, str]]) -> list[str]:
    """Place and words of each sign in these texts."""
    return [f"{place}: ...{found}..." for place, text in texts for found in signs(text)]


@pytest.mark.parametrize(
    "text",
    [
        "Told by whoever asks.",
        "The peer for whom it waits.",
        "A room without a way is drawn anew.",
        "So long a process waits.",
        "It waits\nso long at most.",
        "So far below the floor it lies.",
        "The file says that it has everything.",
        "The path, or None where there is none.",
        "What `legpush run` can be told.",
    ],
)
def test_a_riddle_is_found(text: str) -> None:
    assert len(signs(text)) == 1


@pytest.mark.parametrize(
    "text",
    [
        "Scaled by what pushes have done to this box so far.",
        "There are so many obstacles that no way is left.",
        "Wait as long as it takes.",
        "Options of `legpush run`.",
    ],
)
def test_plain_english_is_no_riddle(text: str) -> None:
    assert signs(text) == []


def test_all_strings_and_comments_of_a_file_are_read(tmp_path: Path) -> None:
    file = tmp_path / "module.py"
    file.write_text('"""Head."""\n\nx = f"a {1} b"  # first\n# second\n\n# third\ny = {"key": "value"}\n')

    assert sorted(words_of(file)) == [
        (1, "Head."),
        (3, "a  b"),
        (3, "first second"),
        (6, "third"),
        (7, "key"),
        (7, "value"),
    ]


@pytest.mark.parametrize("name", FILES)
def test_a_file_of_the_project_has_no_riddles(name: str) -> None:
    assert riddles(iter([(name, (ROOT / name).read_text())])) == []


@pytest.mark.parametrize("folder", FOLDERS)
def test_a_folder_of_the_project_has_no_riddles(folder: str) -> None:
    assert riddles(texts_in(ROOT / folder)) == []


@pytest.mark.parametrize("package", PACKAGES)
def test_a_package_has_no_riddles(package: str) -> None:
    found = riddles(texts_in(ROOT / package))
    assert found == []


def test_no_help_text_has_riddles() -> None:
    assert riddles(iter(help_texts().items())) == []
