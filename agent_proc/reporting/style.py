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
RAW, BOX, GOAL, BLUE = "#c8553d", "#8d6748", "#2b8a4b", "#3a6ea5"
