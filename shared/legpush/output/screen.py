"""A screen for progress: drawing on it ends at its first error, and never reaches the work that is shown."""

import os
from collections.abc import Callable
from typing import Final

from rich.console import Console

COLOURS: Final = "FORCE_COLOR"
"""Set by Jupyter and others, which show colours but keep every line that was drawn over."""


def can_draw_over(console: Console) -> bool:
    """Return whether lines can be drawn over: on a terminal, and not where colours alone are asked for."""
    return console.is_terminal and (console.file.isatty() or not os.environ.get(COLOURS))


class Screen:
    """Draws until that fails once."""

    def __init__(self) -> None:
        self.lost = False
        """Whether drawing has failed."""

    def draw(self, work: Callable[[], object]) -> None:
        """Do the work of drawing, unless the screen is lost."""
        if self.lost:
            return
        try:
            work()
        except (OSError, ValueError, SystemExit):  # Rich raises SystemExit at a broken pipe, closed files ValueError
            self.lost = True
