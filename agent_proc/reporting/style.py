"""Colours and fonts that the pictures share."""

from typing import Any, Final

STYLE: Final[dict[Any, Any]] = {
    "font.size": 9.0,
    "axes.titlesize": 9.5,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.linewidth": 0.7,
    "axes.edgecolor": "#8a8f98",
    "axes.labelcolor": "#333840",
    "xtick.color": "#555b65",
    "ytick.color": "#555b65",
    "legend.frameon": False,
    "legend.fontsize": 8.5,
}
WALL, FLOOR, INK, GRID = "#3b3f46", "#ffffff", "#1b2a41", "#e6e8eb"
RAW, BOX, GOAL, BLUE = "#d55e00", "#a8741a", "#009e73", "#0072b2"
TREE, PATH, GIVEN_UP, APPEARED = "#9dbbdc", "#56b4e9", "#77706a", "#b8651b"
FEET: Final = {"FL": "#e69f00", "FR": "#cc79a7", "RL": "#6f4ba0", "RR": "#3d9fb0"}
"""Colours that are told apart with any colour vision, after Okabe and Ito, *Color Universal Design*, 2008."""
