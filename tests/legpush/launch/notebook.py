"""A display for tests."""

from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import dataclass, field


@dataclass
class Notebook(AbstractContextManager["Notebook"]):
    """A display that remembers; `on_notice` and `on_progress` may act."""

    notices: list[str] = field(default_factory=list)
    shown: list[tuple[str, float | None, str, str]] = field(default_factory=list)
    on_notice: Callable[[str], None] = lambda text: None
    on_progress: Callable[[], None] = lambda: None

    def __exit__(self, *_: object) -> None:
        return None

    def progress(self, phase: str, fraction: float | None, detail: str, waiting_for: str) -> None:
        self.shown.append((phase, fraction, detail, waiting_for))
        self.on_progress()

    def notice(self, text: str) -> None:
        self.notices.append(text)
        self.on_notice(text)
