"""Filming a run: whatever becomes of the film, the mission keeps its result, unless the user interrupts."""

import os
import signal
import sys
from pathlib import Path

import pytest

from legpush.launch.film import film, film_arguments
from legpush.launch.supervisor import Verdict
from legpush.processes.child import Command
from legpush.processes.crew import Crew


class Notices:
    """A display that remembers notices and can interrupt the launcher when it shows progress."""

    def __init__(self, interrupt: bool = False) -> None:
        self.notices: list[str] = []
        self._interrupt = interrupt

    def __enter__(self) -> "Notices":
        return self

    def __exit__(self, *_: object) -> None:
        return None

    def progress(self, phase: str, fraction: float | None, detail: str, waiting_for: str) -> None:
        assert phase == "filming"
        if self._interrupt:
            os.kill(os.getpid(), signal.SIGINT)

    def notice(self, text: str) -> None:
        self.notices.append(text)


def shoot(folder: Path, code: str, display: Notices, longest_s: float = 60.0) -> Verdict | None:
    argv = (sys.executable, "-I", "-S", "-c", code)
    command = Command(role="video", argv=argv, log=folder / "video.log", environment=os.environ)
    with Crew() as crew:
        verdict = film(command, crew, display, display.notice, longest_s)
        assert crew.running() == ()
    return verdict


@pytest.mark.parametrize(
    ("code", "notices"),
    [
        ("pass", []),
        ("print('first'); print('no OpenGL: install libegl1'); raise SystemExit(4)", ["no OpenGL: install libegl1"]),
        ("raise SystemExit(4)", ["no video: no OpenGL library can be used"]),
        (
            "print('what'); print('why'); raise SystemExit(1)",
            [
                "no video: the film exited with 1; the end of {log}:\n    what\n    why",
                "no video: the film exited with 1; its log is {log}",
            ],
        ),
        (
            "print('much'); print('error: no'); raise SystemExit(2)",
            ["no video: the film exited with 2: no; its log is {log}"],
        ),
        ("import os; os.abort()", ["no video: the film was killed by SIGABRT; it wrote nothing to {log}"]),
    ],
)
def test_a_film_or_the_lack_of_one_changes_nothing_but_is_told(code: str, notices: list[str], tmp_path: Path) -> None:
    display = Notices()
    assert shoot(tmp_path, code, display) is None
    assert display.notices == [notice.format(log=tmp_path / "video.log") for notice in notices]


def test_a_film_that_takes_too_long_is_given_up(tmp_path: Path) -> None:
    display = Notices()
    assert shoot(tmp_path, "import signal; signal.pause()", display, longest_s=0.2) is None
    assert display.notices == [f"no video: it was not ready after 0.2 s; see {tmp_path}/video.log"]


def test_an_interrupt_while_filming_ends_the_film_and_the_launcher(tmp_path: Path) -> None:
    verdict = shoot(tmp_path, "import signal; signal.pause()", Notices(interrupt=True))
    assert verdict == Verdict(130, "interrupted by SIGINT while filming")


def test_the_film_process_is_given_the_folder(tmp_path: Path) -> None:
    assert film_arguments(tmp_path)[1:] == ("-P", "-m", "sim_proc.render", str(tmp_path))
