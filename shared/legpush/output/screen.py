"""A screen for progress: drawing on it ends at its first error, and never reaches the work that is shown."""

from collections.abc import Callable


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
