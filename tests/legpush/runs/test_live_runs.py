"""Finding the runs that launchers have going, and choosing the one to watch."""

import os
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

import msgspec
import pytest

from legpush.bus.endpoints import local
from legpush.errors import ConfigError
from legpush.runs.choose_run import choose_run, find_run
from legpush.runs.live_runs import MAX_BYTES, RUN_FILE, LiveRun, find_live_runs, shown, socket_directory
from tests.legpush.fakes import eventually

AT = ("unixsock-stream//tmp/legpush-x/agent.sock", "unixsock-stream//tmp/legpush-x/sim0.sock")


@pytest.fixture(autouse=True)
def temporary(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A temporary directory of its own."""
    monkeypatch.setattr(tempfile, "tempdir", None)
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    monkeypatch.delenv("LEGPUSH_RUN", raising=False)
    return tmp_path


@pytest.fixture
def launch() -> Iterator[Callable[..., Path]]:
    """Shows a run until the test is over, and returns its directory."""
    with ExitStack() as stack:

        def start(name: str = "r1", folder: Path | None = Path("/runs/r1"), kind: str = "train") -> Path:
            directory = stack.enter_context(socket_directory())
            stack.enter_context(shown(LiveRun.now(name, kind, folder, AT), directory))
            return directory

        yield start


def names() -> list[str]:
    return [run.run for run in find_live_runs()]


def test_a_run_is_found_while_it_is_shown_and_not_afterwards(temporary: Path) -> None:
    run = LiveRun.now("r1", "train", Path("/runs/r1"), AT)
    with socket_directory() as directory:
        assert directory.parent == temporary
        assert find_live_runs() == ()
        with shown(run, directory):
            assert find_live_runs() == (run,)
            assert [path.name for path in directory.iterdir()] == [RUN_FILE]
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


LAUNCHER = """
import threading
from legpush.runs.live_runs import LiveRun, shown, socket_directory
with socket_directory() as directory, shown(LiveRun.now("r1", "run", None, ("tcp/127.0.0.1:1",)), directory):
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


def test_without_a_live_run_processes_started_by_hand_are_watched(monkeypatch: pytest.MonkeyPatch) -> None:
    assert find_run() is None
    watched = choose_run()
    assert (watched.run, watched.endpoints.connect) == ("local", local("recorder").connect)
    assert (watched.launched, watched.folder) == (None, None)
    assert choose_run("mine").run == "mine"
    monkeypatch.setenv("LEGPUSH_RUN", "everywhere")
    assert choose_run().run == "everywhere"
    assert choose_run("mine").run == "mine"


def test_the_one_live_run_is_watched(launch: Callable[..., Path]) -> None:
    launch()
    watched = find_run()
    assert watched == choose_run()
    assert watched is not None
    assert (watched.run, watched.endpoints.connect, watched.folder) == ("r1", AT, Path("/runs/r1"))
    assert str(watched) == "r1 (train, in /runs/r1)"


def test_several_live_runs_are_an_error_that_lists_them(launch: Callable[..., Path]) -> None:
    launch("r1")
    launch("r2", None, "calibrate")
    with pytest.raises(ConfigError, match=r"^Expected --run .*: r1 \(train, in /runs/r1\); r2 \(calibrate\)$"):
        choose_run()
    assert choose_run("r2").endpoints.connect == AT
    assert find_run("r3") is None
    assert choose_run("r3").endpoints.connect == local("recorder").connect


def test_a_run_is_known_by_its_folder_too(
    launch: Callable[..., Path], temporary: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for parent in ("a", "b"):
        launch("same", temporary / parent / "same")
    with pytest.raises(ConfigError, match=r"a/same\); same \(train, in .*b/same\)"):
        choose_run("same")
    monkeypatch.chdir(temporary)
    assert choose_run("b/same").folder == temporary / "b" / "same"
    (temporary / "a").mkdir()
    monkeypatch.chdir(temporary / "a")
    assert choose_run("same").folder == temporary / "a" / "same"


def test_the_name_in_the_environment_means_what_the_flag_does(
    launch: Callable[..., Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    launch("r1")
    launch("r2")
    monkeypatch.setenv("LEGPUSH_RUN", "r2")
    assert choose_run().run == "r2"
    assert choose_run("r1").run == "r1"
    monkeypatch.setenv("LEGPUSH_RUN", "mine")
    assert (choose_run().run, choose_run().launched) == ("mine", None)


def test_endpoints_that_are_given_are_watched_whatever_runs(launch: Callable[..., Path]) -> None:
    launch("r1")
    watched = find_run(None, ("tcp/127.0.0.1:5",))
    assert watched is not None
    assert (watched.run, watched.endpoints.connect, watched.launched) == ("local", ("tcp/127.0.0.1:5",), None)
    assert choose_run("r1", ("tcp/127.0.0.1:5",)).endpoints.connect == ("tcp/127.0.0.1:5",)


def test_what_is_neither_name_nor_folder_is_refused_with_those_that_live(launch: Callable[..., Path]) -> None:
    with pytest.raises(ConfigError, match=r"for --run, got 'no/such'; live: none$"):
        choose_run("no/such")
    launch()
    with pytest.raises(ConfigError, match=r"got 'no/such'; live: r1 \(train"):
        choose_run("no/such")


def test_the_file_is_json_that_others_can_read(launch: Callable[..., Path]) -> None:
    plain = msgspec.json.decode((launch() / RUN_FILE).read_bytes())
    assert plain["run"] == "r1"
    assert plain["connect"] == list(AT)
