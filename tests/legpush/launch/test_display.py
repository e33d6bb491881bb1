"""What the user sees of a mission: a line that is redrawn, or plain lines."""

import re
from io import StringIO

import pytest
from rich.console import Console

from legpush.launch.display import LiveDisplay, PlainDisplay, make_display


def plain_lines(console: Console) -> list[str]:
    """What was printed, without the times."""
    assert isinstance(console.file, StringIO)
    return [re.sub(r"^ *[0-9.]+ s  ", "", line) for line in console.file.getvalue().splitlines()]


def test_a_terminal_gets_a_live_display_anything_else_plain_lines() -> None:
    assert isinstance(make_display(Console(file=StringIO(), force_terminal=True)), LiveDisplay)
    assert isinstance(make_display(Console(file=StringIO(), force_terminal=False)), PlainDisplay)


def test_plain_lines_come_with_each_phase_each_tenth_and_each_wait() -> None:
    console = Console(file=StringIO(), width=40)
    with PlainDisplay(console, clock=lambda: 0.0) as display:
        for percent in range(100):
            display.progress("walking", percent / 100, f"{percent} cm", "")
        display.progress("pushing", None, "cycle 1", "")
        display.progress("pushing", None, "cycle 2", "")
        display.progress("pushing", None, "cycle 2", "sim (dead)")
        display.notice("the sim died [of old age]; a line that is longer than the console")
    walking = [f"walking  {percent:3d}%  {percent} cm" for percent in range(0, 100, 10)]
    assert [re.sub(" +", " ", line) for line in plain_lines(console)] == [
        *(re.sub(" +", " ", line) for line in walking),
        "pushing cycle 1",
        "pushing cycle 2 waiting for sim (dead)",
        "the sim died [of old age]; a line that is longer than the console",
    ]


def test_a_long_phase_gets_a_plain_line_every_few_seconds_if_something_changed() -> None:
    console = Console(file=StringIO())
    now = 0.0
    with PlainDisplay(console, clock=lambda: now) as display:
        for cycle in range(60):
            now = 0.5 * cycle
            display.progress("pushing", None, f"cycle {cycle}", "")
        for _ in range(60):
            now += 0.5
            display.progress("pushing", None, "cycle 59", "")
    assert plain_lines(console) == [
        *(f"pushing  cycle {cycle}" for cycle in (0, 10, 20, 30, 40, 50)),
        "pushing  cycle 59",
    ]


def test_the_live_display_shows_the_last_phase_and_keeps_notices() -> None:
    console = Console(file=StringIO(), force_terminal=True, color_system=None, width=120)
    with LiveDisplay(console) as display:
        display.progress("walking", 0.5, "4.0 of 8.0 m", "")
        display.notice("the planner died [sic]")
        display.progress("pushing", None, "cycle 3, 12 cm to go [m]", "sim (slow)")
    assert isinstance(console.file, StringIO)
    text = console.file.getvalue()
    assert "the planner died [sic]" in text
    assert "4.0 of 8.0 m" in text
    assert "cycle 3, 12 cm to go [m]" in text
    assert "waiting for sim (slow)" in text


class Broken(StringIO):
    """A file that takes nothing."""

    def __init__(self, error: Exception) -> None:
        super().__init__()
        self._error = error

    def write(self, text: str) -> int:
        raise self._error


@pytest.mark.parametrize("terminal", [False, True])
@pytest.mark.parametrize("error", [BrokenPipeError(32, "gone"), OSError(28, "full"), ValueError("closed")])
def test_a_display_that_cannot_be_written_to_costs_no_mission(error: Exception, terminal: bool) -> None:
    console = Console(file=Broken(error), force_terminal=terminal, width=80)
    with make_display(console) as display:
        for percent in range(0, 100, 20):
            display.progress("walking", percent / 100, "", "")
            display.notice("the planner died")
