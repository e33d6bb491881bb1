"""Figures of matplotlib, untouched by the user's settings of it. The only module that imports matplotlib.

The backend of the user's shell or notebook is not loaded, and no `matplotlibrc` is read: with a wrong one there would
be no picture, or one of another look.
"""

import os
import sys
import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path
from typing import Any, Final

SETTINGS: Final = {"MPLBACKEND": None, "MATPLOTLIBRC": os.devnull}
"""Environment while matplotlib is imported; None removes a variable. MPLCONFIGDIR stays, since it also has the font
cache; its `matplotlibrc` comes after the one that is named here."""
RC_FILE: Final = "matplotlibrc"
"""The file that matplotlib looks for in the working directory, before all others."""
PICTURES: Final = {".png": "png", ".svg": "svg", ".pdf": "pdf"}
"""Formats of figures by the endings of their files."""
LABELS_IN: Final = 0.45
"""Height of the numbers and the label of an axis."""
PLAIN: Final[Mapping[str, Any]] = {"text.parse_math": False, "text.usetex": False, "svg.hashsalt": "legpush"}
"""Settings of all figures: names of users and their files are shown as they are."""


@contextmanager
def _undisturbed() -> Iterator[None]:
    """Hide the user's settings from matplotlib while it is imported; one that is imported already is left alone."""
    if "matplotlib" in sys.modules:
        yield
        return
    before = {name: os.environ.get(name) for name in SETTINGS}
    with _elsewhere():
        _set_environment(SETTINGS)
        try:
            yield
        finally:
            _set_environment(before)


@contextmanager
def _elsewhere() -> Iterator[None]:
    """Work in another directory if there is a `matplotlibrc` in the working directory."""
    if not os.path.lexists(RC_FILE):
        yield
        return
    here = os.open(".", os.O_RDONLY | os.O_DIRECTORY)
    try:
        os.chdir(Path(__file__).parent)
        try:
            yield
        finally:
            os.fchdir(here)
    finally:
        os.close(here)


def _set_environment(values: Mapping[str, str | None]) -> None:
    for name, value in values.items():
        if value is None:
            os.environ.pop(name, None)
        else:
            os.environ[name] = value


with _undisturbed():
    import matplotlib as mpl
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.collections import LineCollection, PatchCollection
    from matplotlib.colors import to_rgba
    from matplotlib.figure import Figure
    from matplotlib.layout_engine import ConstrainedLayoutEngine
    from matplotlib.patches import FancyBboxPatch, Patch, Polygon, Rectangle
    from matplotlib.ticker import LogLocator, MaxNLocator, NullFormatter
    from matplotlib.transforms import ScaledTranslation

__all__ = [
    "Artist",
    "Axes",
    "ConstrainedLayoutEngine",
    "FancyBboxPatch",
    "Figure",
    "LineCollection",
    "LogLocator",
    "MaxNLocator",
    "NullFormatter",
    "Patch",
    "PatchCollection",
    "Polygon",
    "Rectangle",
    "legend_below",
    "own_style",
    "plain_log_ticks",
    "save_figure",
    "to_rgba",
]


@contextmanager
def own_style(more: Mapping[str, Any] | None = None) -> Iterator[None]:
    """Draw with the defaults of matplotlib, the settings `PLAIN` and `more`; other settings are back afterwards."""
    settings: dict[Any, Any] = {name: value for name, value in mpl.rcParamsDefault.items() if name != "backend"}
    with mpl.rc_context():
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", mpl.MatplotlibDeprecationWarning)
            mpl.rcParams.update(settings | dict(PLAIN) | dict(more or {}))
        yield


def save_figure(figure: Figure, path: Path, *, dpi: float | None = None, software: str | None = None) -> None:
    """Write a figure, in the format of the ending of `path`. It has to be drawn and saved in one `own_style`.

    Equal figures give equal files: nothing in them says when they were made. `software` is named as their author in PNG
    files, and `dpi` is their resolution.

    Raises:
        OSError: The file cannot be written.
    """
    picture, made = BytesIO(), PICTURES[path.suffix.lower()]
    plain: dict[str, str | None] = {"Date": None} if made == "svg" else {"CreationDate": None} if made == "pdf" else {}
    metadata = plain if made != "png" else None if software is None else {"Software": software}
    FigureCanvasAgg(figure)
    figure.savefig(picture, format=made, dpi=dpi, metadata=metadata)
    path.write_bytes(picture.getvalue())


def legend_below(axis: Axes, *, n_columns: int) -> None:
    """Place the legend of an axis below it and its labels, where it covers no data."""
    figure = axis.get_figure(root=True)
    if figure is None:
        raise ValueError("Expected an axis of a figure")
    below = axis.transAxes + ScaledTranslation(0.0, -LABELS_IN, figure.dpi_scale_trans)
    axis.legend(
        loc="upper center", bbox_to_anchor=(0.5, 0.0), bbox_transform=below, ncols=n_columns, fontsize=8, frameon=False
    )


def plain_log_ticks(axis: Axis) -> None:
    """Label a logarithmic axis with 0.1, 0.2, 0.5, 1, ..."""
    axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axis.set_major_formatter("{x:g}")
    axis.set_minor_formatter(NullFormatter())
