"""The formats of map files, by their suffixes."""

from pathlib import PurePath
from typing import Final, Literal

CELL_SUFFIXES: Final = (".csv", ".npy")
"""Files that have only cells: the size of a cell and the place of the first row must be given besides."""
MAP_SERVER_SUFFIXES: Final = (".yaml", ".yml")
"""Files that have the size of a cell, and whose first row is the top one."""
IMAGE_SUFFIXES: Final = (".pgm", ".png")
"""The images of these files."""
FirstRow = Literal["top", "bottom"]
"""Place of the first row of a file: at the highest y, as in a picture, or at y = 0."""


def suffix_of(name: str) -> str:
    """Return the ending of a file's name, in lower case."""
    return PurePath(name).suffix.lower()
