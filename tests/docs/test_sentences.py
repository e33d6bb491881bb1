"""Pages, docstrings, comments, messages and help texts are in plain English, without the signs of a riddle."""

import ast
import importlib
import re
import tokenize
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import tyro

from legpush import cli
from legpush.errors import LegpushError

ROOT = Path(__file__).parents[2]
PACKAGES = ("shared/legpush", "sim_proc", "planner_proc", "agent_proc")
OTHER_FOLDERS = ("docs", "examples", "benchmarks", "experiments")
NOT_YET = ["shared/legpush", "sim_proc", "planner_proc", "agent_proc"]
"""Packages whose sentences are still to be rewritten: this list shrinks to nothing."""

SIGNS = [
    re.compile(sign, re.IGNORECASE)
    for sign in (
        r"\bwho(?:so)?(?:m|mso)?ever\b",
        r"\bwhom\b",
        r"\banew\b",
        # "So long a process waits", "waits so long at most"; "so many obstacles that no way is left" is fine.
        r"\bso (?:many|much|long|often)\b(?!(?: [\w-]+){0,3} (?:that|as)\b)",
        r"(?:^|[.,;:!?(|-] *)so far\b",
        r"\bthat it has\b",
        r"\bwhere there (?:is|are) none\b",
        r"\bwhat there is\b",
        r"\bcan be told\b",
    )
]
COMMANDS = (
    "run",
    "train",
    "evaluate",
    "calibrate",
    "plan-check",
    "scenarios list",
    "scenarios show",
    "scenarios copy",
    "scenarios random",
    "map",
    "render",
    "record",
    "info",
    "recover",
    "replay",
    "branch",
    "export",
    "view",
)


def signs(text: str) -> list[str]:
    """The signs of a riddle in a text, each with some words around it."""
    flat = " ".join(text.split())
    return [
        flat[max(0, found.start() - 40) : found.end() + 40].strip() for sign in SIGNS for found in sign.finditer(flat)
    ]


def sentences(path: Path) -> Iterator[tuple[int, str]]:
    """Line and text of the strings (docstrings among them) and of the blocks of comments in a Python file."""
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            yield node.lineno, node.value
        elif isinstance(node, ast.JoinedStr):
            yield node.lineno, "".join(str(part.value) for part in node.values if isinstance(part, ast.Constant))
    block: list[str] = []
    at = 0
    with path.open("rb") as file:
        for token in tokenize.tokenize(file.readline):
            if token.type == tokenize.COMMENT:
                if block and token.start[0] > at + len(block):
                    yield at, " ".join(block)
                    block = []
                at = at if block else token.start[0]
                block.append(token.string.lstrip("# "))
    if block:
        yield at, " ".join(block)


def texts_of(folder: str) -> Iterator[tuple[str, str]]:
    """Place and text of all that a folder says to people: Python files, pages and scenario files."""
    for path in sorted((ROOT / folder).rglob("*")):
        name = path.relative_to(ROOT).as_posix()
        if path.suffix == ".py":
            for line, text in sentences(path):
                yield f"{name}:{line}", text
        elif path.suffix in (".md", ".toml", ".cjs"):
            yield name, path.read_text()


def riddles(texts: Iterator[tuple[str, str]]) -> list[str]:
    return [f"{place}: ... {found} ..." for place, text in texts for found in signs(text)]


@pytest.mark.parametrize(
    "text",
    [
        "Told by whoever asks.",
        "The one whom it waits for.",
        "A room without a way is drawn anew.",
        "So long a process waits.",
        "It waits so long at most.",
        "So far below the floor is what has not appeared.",
        "Says of what it has\nthat it has it.",
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


def test_strings_and_comments_of_a_file_are_all_read(tmp_path: Path) -> None:
    file = tmp_path / "module.py"
    file.write_text('"""Head."""\n\nx = f"a {1} b"  # first\n# second\n# third\n\n# fourth\n')

    assert sorted(text for _, text in sentences(file)) == ["Head.", "a ", " b", "a  b", "first second third", "fourth"][
        :0
    ] + sorted(["Head.", "a ", " b", "a  b", "first second third", "fourth"])


def test_pages_have_no_riddles() -> None:
    pages = [ROOT / name for name in ("README.md", "CHANGELOG.md", "compose.yaml", "Dockerfile", "Makefile")]
    assert riddles((page.name, page.read_text()) for page in pages) == []


@pytest.mark.parametrize("folder", OTHER_FOLDERS)
def test_a_folder_has_no_riddles(folder: str) -> None:
    assert riddles(texts_of(folder)) == []
