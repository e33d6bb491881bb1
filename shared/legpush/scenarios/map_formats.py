"""The formats of map files, by their suffixes."""

from pathlib import PurePath
from typing import Final, Literal

CELL_SUFFIXES: Final = (".csv", ".npy")
"""Files of nothing but cells: how large a cell is, and where the first row lies, has to be said beside them."""
MAP_SERVER_SUFFIXES: Final = (".yaml", ".yml")
"""Files that say all of it."""
IMAGE_SUFFIXES: Final = (".pgm", ".png")
"""What they name as their image."""
FirstRow = Literal["top", "bottom"]
"""Where the first row of a file lies: at the highest y, as in a picture, or at y = 0."""


def suffix_of(name: str) -> str:
    """The end of a file's name by which its kind is known, in lower case."""
    return PurePath(name).suffix.lower()
