"""Configuration of the documentation site: `make docs` builds it in `runs/site`.

Pages are Markdown, as they are read in the repository. Links to files of the repository become downloads; links to
folders, and to pages outside this folder, are plain text. The site has `external_links.txt`: all links to other sites.
"""

import os
import re
import sys
from importlib.metadata import version as installed_version
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from sphinx.ext.napoleon.docstring import GoogleDocstring

if TYPE_CHECKING:
    from sphinx.application import Sphinx

DOCS: Final = Path(__file__).parent
LINKS: Final = "external_links.txt"

project = "legpush"
author = "The authors of legpush"
release = version = installed_version("legpush")
extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx_copybutton"]
exclude_patterns = ["templates", "schemas"]

# Two dashes are the beginning of an option here.
smartquotes = False

html_theme = "furo"
html_title = f"legpush {release}"
html_show_copyright = False
html_show_sphinx = False
html_copy_source = False
html_theme_options: dict[str, Any] = {
    "light_css_variables": {
        "color-brand-primary": "#2f6690",
        "color-brand-content": "#2f6690",
        "picture-brightness": "1",
    },
    "dark_css_variables": {
        "color-brand-primary": "#8ab8d9",
        "color-brand-content": "#8ab8d9",
        "picture-brightness": "0.8",
    },
}
html_css_files = ["legpush.css"]
html_static_path = ["static"]
html_extra_path = ["llms.txt"]

myst_heading_anchors = 4
myst_enable_extensions = ["colon_fence"]
nb_execution_mode = "force"
nb_execution_raise_on_error = True
nb_execution_timeout = 300
nb_execution_in_temp = True
nb_merge_streams = True

autodoc_member_order = "bysource"
autodoc_typehints = "description"
autodoc_typehints_description_target = "documented_params"
autodoc_default_options = {"members": True, "undoc-members": False}

# Names in docstrings stand between single backticks.
default_role = "literal"

# Notebooks call `legpush`, whose command lies beside this interpreter.
os.environ["PATH"] = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])

_LINK: Final = re.compile(r"\[([^\]]+)\]\(((?!https?://)[^)#\s]+)(#[^)\s]*)?\)")
_EXTERNAL: Final = re.compile(r'<a class="reference external" href="(https?://[^"#]+)')


def _without_dead_links(_app: "Sphinx", page: str, source: list[str]) -> None:
    """Replace links that a site has no page for by their text."""

    def text(found: "re.Match[str]") -> str:
        target = ((DOCS / page).parent / found[2]).resolve()
        is_elsewhere = target.suffix == ".md" and not target.is_relative_to(DOCS)
        return found[1] if target.is_dir() or is_elsewhere else found[0]

    source[0] = _LINK.sub(text, source[0])


def _read_sections(_app: "Sphinx", what: Any, _name: str, _object: object, _options: object, lines: list[str]) -> None:
    """Turn the sections of a docstring into fields.

    The text of an attribute has no sections. Napoleon would take the words before its first colon for a type.
    """
    if what not in ("attribute", "property"):
        lines[:] = GoogleDocstring(lines, what=what).lines()


def _link_pictures(_app: "Sphinx", page: Any) -> None:
    """Give every picture a width: Sphinx then links it to its full size, in which small print can be read."""
    for picture in page.findall(lambda node: node.tagname == "image"):
        picture.setdefault("width", "100%")


def _list_external_links(app: "Sphinx", error: Exception | None) -> None:
    """Write all links to other sites, each with the pages that have it."""
    if error is not None or app.builder.name != "html":
        return
    found: dict[str, list[str]] = {}
    for page in sorted(app.outdir.rglob("*.html")):
        for link in _EXTERNAL.findall(page.read_text()):
            found.setdefault(link, []).append(str(page.relative_to(app.outdir)))
    lines = (f"{link}  {' '.join(dict.fromkeys(pages))}\n" for link, pages in sorted(found.items()))
    (app.outdir / LINKS).write_text("".join(lines))


def setup(app: "Sphinx") -> None:
    """Register what happens to a page before it is read, and to the site when it is built."""
    app.connect("source-read", _without_dead_links)
    app.connect("autodoc-process-docstring", _read_sections)
    app.connect("doctree-read", _link_pictures)
    app.connect("build-finished", _list_external_links)
