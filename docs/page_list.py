"""The list of all pages in `llms.txt`: what language models and other programs read first."""

import re
from pathlib import Path
from typing import Final

DOCS: Final = Path(__file__).parent
LLMS: Final = DOCS / "llms.txt"
_TOCTREE: Final = re.compile(r"^:::\{toctree\}\n:hidden:\n:caption: (?P<title>.+)\n\n(?P<pages>(?:.+\n)+?):::$", re.M)


def sections() -> dict[str, tuple[str, ...]]:
    """Return the names of the pages of the site by section, in their order."""
    text = (DOCS / "index.md").read_text()
    return {found["title"]: tuple(found["pages"].split()) for found in _TOCTREE.finditer(text)}


def llms_text() -> str:
    """Return the list in the format of llmstxt.org: title, summary, and a link with one sentence for each page."""
    _, summary = _title_and_text(DOCS / "index.md")
    lines = ["# legpush", "", f"> {summary.partition('. ')[2]}", ""]
    for section, pages in sections().items():
        lines += [f"## {section}", ""]
        for page in pages:
            title, text = _title_and_text(DOCS / f"{page}.md")
            lines.append(f"- [{title}]({page}.html): {_first_sentence(text)}")
        lines.append("")
    return "\n".join(lines)


def _title_and_text(page: Path) -> tuple[str, str]:
    """Return the title of a page and its first paragraph, without links."""
    title, _, rest = page.read_text().partition("# ")[2].partition("\n\n")
    paragraph = rest.partition("\n\n")[0]
    return title, re.sub(r"\[([^\]]+)\]\([^)]+\)", r"\1", " ".join(paragraph.split()))


def _first_sentence(text: str) -> str:
    return re.split(r"(?<=[.:]) (?=[A-Z])", text)[0]
