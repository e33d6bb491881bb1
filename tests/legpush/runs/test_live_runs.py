"""Finding the runs that launchers have going."""

import os
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

import msgspec
import pytest

from legpush.bus.endpoints import in_directory, in_pool
from legpush.runs.folder import COMMAND_FILE, LOGS
from legpush.runs.live_runs import (
    MAX_BYTES,
    RUN_FILE,
    LiveRun,
    clear_killed_runs,
    find_live_runs,
    shown,
    socket_directory,
)
from legpush.runs.temporary import OWNER_FILE
from tests.legpush.fakes import eventually
from tests.legpush.runs.conftest import AT


def names() -> list[str]:
    return [run.run for run in find_live_runs()]


def test_a_run_is_found_while_it_is_shown_and_not_afterwards(temporary: Path) -> None:
    run = LiveRun.now("r1", "train", Path("/runs/r1"), AT)
    with socket_directory() as directory:
        assert directory.parent == temporary
        assert find_live_runs() == ()
        with shown(run, directory):
            assert find_live_runs() == (run,)
            assert sorted(path.name for path in directory.iterdir()) == [OWNER_FILE, RUN_FILE]
        assert find_live_runs() == ()
    assert run.pid == os.getpid()
    assert str(run) == "r1 (train, in /runs/r1)"


def test_runs_come_in_the_order_in_which_they_began(launch: Callable[..., Path]) -> None:
    for name in ("b", "c", "a"):
        launch(name)
    assert names() == ["b", "c", "a"]


def test_runs_of_another_temporary_directory_are_not_found(
    launch: Callable[..., Path], temporary: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    launch()
    other = temporary / "other"
    other.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(other))
    assert names() == []
    launch("r2")
    assert names() == ["r2"]


@pytest.mark.parametrize("name", ["x" * 90, "what?", "a#b", "new\nline", "\udcff"])
def test_where_a_temporary_directory_cannot_have_sockets_the_run_is_in_tmp_and_found(
    name: str, launch: Callable[..., Path], temporary: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    strange = temporary / name
    strange.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(strange))
    directory = launch("far_away")
    assert directory.parent == Path("/tmp")
    assert directory.stat().st_mode & 0o777 == 0o700
    assert "far_away" in names()
    for role in ("planner", "agent", "sim"):
        assert in_directory(directory, role).listen


def test_the_longest_temporary_directory_that_is_used_has_place_for_all_sockets(
    launch: Callable[..., Path], temporary: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    used = []
    for n in range(50, 78):
        folder = Path("/".join((str(temporary), "x" * (n - len(str(temporary)) - 1))))
        folder.mkdir(exist_ok=True)
        monkeypatch.setattr(tempfile, "tempdir", str(folder))
        directory = launch(f"r{n}")
        in_pool(directory, "sim999")
        assert in_directory(directory, "planner").listen
        used.append(directory.parent == folder)
    assert used[0]
    assert not used[-1]


LAUNCHER = """
import sys, threading
from pathlib import Path
from legpush.runs.live_runs import LiveRun, shown, socket_directory
folder = Path(sys.argv[1]) if sys.argv[1:] else None
with socket_directory() as directory, shown(LiveRun.now("r1", "run", folder, ("tcp/127.0.0.1:1",)), directory):
    threading.Event().wait()
"""


def test_what_a_killed_launcher_left_behind_is_no_run(temporary: Path) -> None:
    with subprocess.Popen([sys.executable, "-c", LAUNCHER]) as launcher:
        assert eventually(lambda: names() == ["r1"])
        assert find_live_runs()[0].pid == launcher.pid
        launcher.kill()
    (left,) = temporary.glob(f"legpush-*/{RUN_FILE}")
    assert names() == []
    assert left.exists()


def test_what_killed_launchers_left_behind_is_cleared_and_the_command_that_goes_on_is_told(
    launch: Callable[..., Path], temporary: Path
) -> None:
    runs = [temporary / "runs" / name for name in ("whole", "without")]
    for run in runs:
        (run / LOGS).mkdir(parents=True)
    (runs[0] / LOGS / COMMAND_FILE).write_text("legpush run --out \x1b[2J\n")
    alive = launch("alive", runs[0])
    for run in (*runs, temporary / "nowhere"):
        with subprocess.Popen([sys.executable, "-c", LAUNCHER, str(run)]) as launcher:
            assert eventually(lambda: len(names()) == 2)
            launcher.kill()
    assert len(list(temporary.glob("legpush-*"))) == 4

    assert clear_killed_runs() == [f"`legpush run` in {runs[0]} was killed; to go on: legpush run --out \\x1b[2J"]
    assert list(temporary.glob("legpush-*")) == [alive]
    assert names() == ["alive"]
    assert clear_killed_runs() == []


@pytest.mark.parametrize("mode", [0o755, 0o710, 0o701])
def test_a_directory_that_others_may_enter_is_skipped(launch: Callable[..., Path], mode: int) -> None:
    directory = launch()
    assert names() == ["r1"]
    directory.chmod(mode)
    assert names() == []


def test_a_directory_of_another_user_is_skipped(launch: Callable[..., Path], monkeypatch: pytest.MonkeyPatch) -> None:
    launch()
    uid = os.getuid()
    monkeypatch.setattr(os, "getuid", lambda: uid + 1)
    assert names() == []


def test_a_link_to_a_directory_is_skipped(launch: Callable[..., Path], temporary: Path) -> None:
    directory = launch()
    (temporary / "elsewhere").mkdir()
    directory.rename(temporary / "elsewhere" / "d")
    assert names() == []
    directory.symlink_to(temporary / "elsewhere" / "d")
    assert names() == []
    directory.unlink()
    (temporary / "elsewhere" / "d").rename(directory)
    assert names() == ["r1"]


@pytest.mark.parametrize(
    "change",
    [
        lambda data: data[:-1],
        lambda data: b"",
        lambda data: b"[]",
        lambda data: data.replace(b'"r1"', b'"r1\xff"'),
        lambda data: data.replace(b'"r1"', b'"r 1"'),
        lambda data: data.replace(b"{", b'{"more": 1, '),
        lambda data: data.replace(b'"protocol":', b'"protocol":1'),
        lambda data: data.replace(b"unixsock-stream/", b"udp/"),
        lambda data: data.replace(b"train", b"\\u001b[2J"),
        lambda data: data + b" " * MAX_BYTES,
    ],
)
def test_a_file_that_is_none_of_a_launcher_is_skipped(
    launch: Callable[..., Path], change: Callable[[bytes], bytes]
) -> None:
    file = launch() / RUN_FILE
    data = file.read_bytes()
    file.write_bytes(data + b" ")
    assert names() == ["r1"]
    assert change(data) != data
    file.write_bytes(change(data))
    assert names() == []


def test_links_pipes_and_directories_in_place_of_the_file_are_skipped(launch: Callable[..., Path]) -> None:
    file = launch() / RUN_FILE
    moved = file.with_name("moved.json")
    file.rename(moved)
    file.symlink_to(moved)
    assert names() == []
    file.unlink()
    os.mkfifo(file)
    assert names() == []
    file.unlink()
    file.mkdir()
    assert names() == []
    file.rmdir()
    moved.rename(file)
    assert names() == ["r1"]


def test_the_file_is_json_that_others_can_read(launch: Callable[..., Path]) -> None:
    plain = msgspec.json.decode((launch() / RUN_FILE).read_bytes())
    assert plain["run"] == "r1"
    assert plain["connect"] == list(AT)
