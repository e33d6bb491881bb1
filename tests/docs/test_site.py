"""The documentation site: built as a user builds it, without a warning, and whole."""

import re
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

import pytest

import legpush
from docs import command_table, generate, page_list, public_names
from docs.protocol_records import SECTIONS
from legpush.runs.reasons import REASONS

ROOT = Path(__file__).parents[2]
FIRST_PAGE_BYTES = 200_000
"""Largest size of the first page with all that it loads but pictures."""


class Page(HTMLParser):
    """Links, anchors and files of a page."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.links: list[str] = []
        self.anchors: set[str] = set()
        self.loads: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Keep what leads somewhere."""
        values = dict(attrs)
        if name := values.get("id"):
            self.anchors.add(name)
        if tag == "a" and (href := values.get("href")):
            self.links.append(href)
        for key in ("src", "href"):
            if tag in ("script", "link", "img") and (value := values.get(key)):
                self.loads.append(value)


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-m", "sphinx", "-q", "-W", "--keep-going", "-b", "html", "-d", f"{folder / 'trees'}"]
    done = subprocess.run(
        [*command, "docs", f"{folder / 'html'}"], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return folder / "html"


@pytest.fixture(scope="module")
def pages(site: Path) -> dict[Path, Page]:
    return {path: Page(path.read_text()) for path in sorted(site.rglob("*.html"))}


def test_every_page_of_the_repository_is_in_the_site_and_in_its_contents(site: Path) -> None:
    named = {name for names in page_list.sections().values() for name in names}
    there = {path.relative_to(generate.DOCS).with_suffix("").as_posix() for path in generate.DOCS.rglob("*.md")}
    there = {name for name in there if not name.startswith("templates/")}

    assert named | {"index"} == there
    assert [name for name in there if not (site / f"{name}.html").exists()] == []


def test_links_and_files_within_the_site_exist(site: Path, pages: dict[Path, Page]) -> None:
    dead = []
    for path, page in pages.items():
        for link in [*page.links, *page.loads]:
            parts = urlsplit(link)
            if parts.scheme or parts.netloc:
                continue
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            if not target.exists() or (
                parts.fragment and target in pages and unquote(parts.fragment) not in pages[target].anchors
            ):
                dead.append(f"{path.relative_to(site)}: {link}")
    assert dead == []


def test_nothing_is_loaded_from_another_site(pages: dict[Path, Page]) -> None:
    assert [load for page in pages.values() for load in page.loads if urlsplit(load).netloc] == []


def test_every_picture_leads_to_its_full_size(pages: dict[Path, Page]) -> None:
    pictures = {load for page in pages.values() for load in page.loads if load.endswith((".png", ".jpg"))}
    assert pictures
    assert pictures <= {link for page in pages.values() for link in page.links}


def test_the_text_of_an_attribute_stays_whole(site: Path) -> None:
    api = re.sub("<[^>]+>", "", (site / "api.html").read_text())
    assert "Exit code of the process: 2 for bad input" in api
    assert "of even density. cuboid: all of it." in api


def test_links_to_other_sites_are_listed(site: Path, pages: dict[Path, Page]) -> None:
    listed = {line.split()[0] for line in (site / "external_links.txt").read_text().splitlines()}
    used = {link.partition("#")[0] for page in pages.values() for link in page.links if urlsplit(link).netloc}
    # The theme names itself and its maker in the footer.
    assert {link for link in used - listed if "furo" not in link and "pradyunsg" not in link} == set()


def test_the_first_page_is_small(site: Path, pages: dict[Path, Page]) -> None:
    files = {(site / urlsplit(load).path).resolve() for load in pages[site / "index.html"].loads}
    shown = [path for path in files if path.suffix in (".css", ".js")]

    assert (site / "index.html").stat().st_size + sum(path.stat().st_size for path in shown) <= FIRST_PAGE_BYTES


def test_every_public_name_command_reason_and_message_has_its_entry(pages: dict[Path, Page], site: Path) -> None:
    api, commands = ((site / f"{name}.html").read_text() for name in ("api", "commands"))
    protocol, run = ((site / f"{name}.html").read_text() for name in ("protocol", "run"))

    for name in legpush.__all__:
        assert name.startswith("_") or re.search(rf'id="legpush\.{name}"', api), name
    for name in command_table.command_names():
        assert f"legpush-{name.replace(' ', '-')}" in pages[site / "commands.html"].anchors, name
    for record in (record for records in SECTIONS.values() for record in records):
        assert record.__name__.lower() in pages[site / "protocol.html"].anchors, record
    assert [name for name in REASONS if f">{name}<" not in run] == []
    assert "--inject-faults" in commands
    assert "docking_m" in protocol


def test_generated_pages_are_not_stale() -> None:
    for page, part in (("commands", command_table.command_tables()), ("api", public_names.public_names())):
        text = (generate.DOCS / f"{page}.md").read_text()
        assert generate.filled(text, {"commands": part, "names": part}) == text, "run `python -m docs.generate`"
    assert page_list.LLMS.read_text() == page_list.llms_text(), "run `python -m docs.generate`"


def test_every_option_of_a_command_is_in_its_table() -> None:
    for name in command_table.command_names():
        text = command_table.help_text(name)
        found = {row for box in command_table.read_help(text).boxes.values() for row, _ in box}
        options = set(re.findall(r"^ {2,4}(--?[a-z][\w-]*)", text, re.MULTILINE))
        assert options <= {option.split(",")[0].split()[0] for option in found}, name
