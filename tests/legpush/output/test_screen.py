"""A screen that cannot be drawn on is given up, and nobody has to care."""

import io

import pytest
from rich.console import Console

from legpush.output.screen import Screen, can_draw_over


@pytest.mark.parametrize(
    "error", [BrokenPipeError(32, "gone"), OSError(28, "full"), ValueError("closed"), SystemExit(1)]
)
def test_a_screen_is_given_up_at_its_first_error(error: BaseException) -> None:
    screen, drawn = Screen(), []

    def fail() -> None:
        drawn.append("fail")
        raise error

    screen.draw(lambda: drawn.append("first"))
    screen.draw(fail)
    screen.draw(lambda: drawn.append("second"))
    assert (drawn, screen.lost) == (["first", "fail"], True)


@pytest.mark.parametrize("error", [KeyboardInterrupt(), RuntimeError("a bug")])
def test_other_errors_are_not_hidden(error: BaseException) -> None:
    def fail() -> None:
        raise error

    with pytest.raises(type(error)):
        Screen().draw(fail)


@pytest.mark.parametrize(
    ("force_terminal", "colours", "expected"),
    [(True, "", True), (True, "1", False), (False, "1", False), (None, "", False)],
)
def test_colours_alone_are_no_terminal(
    force_terminal: bool | None, colours: str, expected: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("FORCE_COLOR", colours)
    console = Console(file=io.StringIO(), force_terminal=force_terminal)
    assert can_draw_over(console) is expected
