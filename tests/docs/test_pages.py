"""Every page can be built into a site, and what it links to, names and runs exists."""

import importlib.util
import re
import shlex
from importlib.metadata import entry_points
from pathlib import Path
from typing import NoReturn, get_args

import pytest

import legpush
from docs import generate
from legpush.cli import command as cli
from legpush.plugins import Group
from tests.command_names import command_names
from tests.docs.help_texts import help_texts

ROOT = Path(__file__).parents[2]
README = ROOT / "README.md"
PAGES = sorted(generate.DOCS.glob("*.md"))
ALL = [README, *PAGES, *(ROOT / f"{name}.md" for name in ("SECURITY", "CHANGELOG", "CONTRIBUTING"))]
CODE = re.compile(r"^```([\w{}-]*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
INLINE = re.compile(r"`([^`\n]+)`")
NO_MODULES = {*entry_points().groups, *get_args(Group), *(f"legpush.{name}" for name in legpush.__all__)}
"""Groups of plug-ins and public names, which look like modules."""


def prose(page: Path) -> str:
    """The page without its blocks of code."""
    return CODE.sub("", page.read_text())


def shell_lines(page: Path) -> list[str]:
    """The commands in the `sh` blocks of a page, without their comments."""
    blocks = [text for language, text in CODE.findall(page.read_text()) if language == "sh"]
    return [line.partition(" # ")[0].strip() for block in blocks for line in block.splitlines() if line.strip()]


def python_blocks(page: Path) -> list[str]:
    """The blocks of Python of a page, which are one program."""
    return [text for language, text in CODE.findall(page.read_text()) if language == "python"]


def anchors(page: Path) -> set[str]:
    """The anchors of a page's headings, as GitHub makes them."""
    headings = re.findall(r"^#+ (.+)$", prose(page), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


WITH_PYTHON = [page for page in PAGES if page.stem != "write_a_planner" and python_blocks(page)]
"""`write_a_planner.md` has a test of its own, which runs it as its readers would."""


def test_some_page_has_python() -> None:
    assert WITH_PYTHON


@pytest.mark.parametrize("page", ALL, ids=lambda page: page.stem)
def test_a_page_begins_with_its_only_title(page: Path) -> None:
    titles = re.findall(r"^# .+$", prose(page), re.MULTILINE)

    assert titles == [page.read_text().splitlines()[0]]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_a_page_says_first_what_it_is_for(page: Path) -> None:
    assert page.read_text().splitlines()[2].startswith("This page ")


@pytest.mark.parametrize("page", ALL, ids=lambda page: page.stem)
def test_a_page_has_no_html_but_the_marks_of_generated_parts(page: Path) -> None:
    text = re.sub(r"<!-- (generated: \w+|end) -->", "", INLINE.sub("", prose(page)))

    assert re.findall(r"<[a-zA-Z/!][^>]*>", text) == []


@pytest.mark.parametrize("page", ALL, ids=lambda page: page.stem)
def test_the_links_of_a_page_lead_somewhere(page: Path) -> None:
    for target in re.findall(r"\]\(([^)]+)\)", INLINE.sub("``", prose(page))):
        if target.startswith("https://"):
            continue
        path, _, anchor = target.partition("#")
        linked = (page.parent / path).resolve() if path else page
        assert linked.exists(), target
        assert not anchor or anchor in anchors(linked), target


def test_the_beginning_links_to_every_page_and_the_readme_is_short() -> None:
    index, readme = (generate.DOCS / "index.md").read_text(), README.read_text()

    assert [page.name for page in PAGES if page.stem != "index" and f"({page.name})" not in index] == []
    assert "(docs/index.md)" in readme
    assert len(readme.splitlines()) <= 150


@pytest.mark.parametrize("page", ALL, ids=lambda page: page.stem)
def test_the_files_and_modules_that_a_page_names_exist(page: Path) -> None:
    folders = {path.name for path in ROOT.iterdir() if path.is_dir()} - {"runs"}
    for name in INLINE.findall(prose(page)):
        if re.fullmatch(r"[\w./*-]+", name) and "/" in name and name.split("/")[0] in folders:
            assert list(ROOT.glob(name)), name
        elif re.fullmatch(r"(legpush|agent_proc|planner_proc|sim_proc)(\.\w+)+", name) and name not in NO_MODULES:
            assert importlib.util.find_spec(name) is not None, name


@pytest.mark.parametrize("page", ALL, ids=lambda page: page.stem)
def test_the_programs_that_a_page_names_can_be_run(page: Path) -> None:
    for module in re.findall(r"python -m ([\w.]+)", page.read_text()):
        found = importlib.util.find_spec(module)
        assert found is not None, module
        if found.submodule_search_locations:
            found = importlib.util.find_spec(f"{module}.__main__")
        assert found is not None, module
        assert found.origin is not None
        assert '__name__ == "__main__"' in Path(found.origin).read_text(), module
    for script in re.findall(r"python ((?:experiments|benchmarks|docs|examples)/\w+\.py)", page.read_text()):
        assert '__name__ == "__main__"' in (ROOT / script).read_text(), script


@pytest.mark.parametrize("page", [README, *PAGES], ids=lambda page: page.stem)
def test_the_legpush_commands_of_a_page_are_understood(
    page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    understood: list[object] = []

    def execute(command: object) -> int:
        understood.append(command)
        return 0

    def start_program(program: str, argv: object) -> NoReturn:
        understood.append(program)
        raise SystemExit(0)

    monkeypatch.setattr(cli, "execute", execute)
    monkeypatch.setattr(cli, "start_program", start_program)
    monkeypatch.setattr(cli, "start_python", lambda argv: start_program("python", argv))
    wanted = [line for line in shell_lines(page) if line.startswith("legpush ")]
    for line in wanted:
        try:
            code = cli.main(shlex.split(line)[1:])
        except SystemExit as end:
            code = end.code if isinstance(end.code, int) else 1
        assert code == 0, line
    assert len(understood) == sum("--help" not in line for line in wanted)


@pytest.mark.parametrize("page", ALL, ids=lambda page: page.stem)
def test_the_commands_and_flags_in_the_text_of_a_page_exist(page: Path) -> None:
    known = {word for text in help_texts().values() for word in re.findall(r"--[a-z][\w-]*", text)} | {"--version"}
    for code in INLINE.findall(prose(page)):
        words = code.split()
        if words[0] == "legpush" and len(words) > 1 and re.fullmatch("[a-z][a-z-]*", words[1]):
            assert words[1] in ("", *command_names()), code
        if words[0] == "legpush" or code.startswith("--"):
            assert set(re.findall(r"(?<![\w-])--[a-z][\w-]*", code)) <= known, code


@pytest.mark.parametrize("page", WITH_PYTHON, ids=lambda page: page.stem)
def test_the_python_of_a_page_runs(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {"__name__": page.stem}
    for block in python_blocks(page):
        exec(compile(block, page.name, "exec"), names)
