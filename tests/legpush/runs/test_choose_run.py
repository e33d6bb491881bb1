"""Choosing the run to watch."""

from collections.abc import Callable
from pathlib import Path

import pytest

from legpush.bus.endpoints import local
from legpush.errors import ConfigError
from legpush.runs.choose_run import choose_run, find_run
from tests.legpush.runs.conftest import AT


def test_without_a_live_run_processes_started_by_hand_are_watched(monkeypatch: pytest.MonkeyPatch) -> None:
    assert find_run() is None
    chosen = choose_run()
    assert (chosen.run, chosen.endpoints.connect) == ("local", local("recorder").connect)
    assert (chosen.launched, chosen.folder) == (None, None)
    assert choose_run("mine").run == "mine"
    monkeypatch.setenv("LEGPUSH_RUN", "everywhere")
    assert choose_run().run == "everywhere"
    assert choose_run("mine").run == "mine"


def test_the_one_live_run_is_watched(launch: Callable[..., Path]) -> None:
    launch()
    chosen = find_run()
    assert chosen == choose_run()
    assert chosen is not None
    assert (chosen.run, chosen.endpoints.connect, chosen.folder) == ("r1", AT, Path("/runs/r1"))
    assert str(chosen) == "r1 (train, in /runs/r1)"


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
    chosen = find_run(None, ("tcp/127.0.0.1:5",))
    assert chosen is not None
    assert (chosen.run, chosen.endpoints.connect, chosen.launched) == ("local", ("tcp/127.0.0.1:5",), None)
    assert choose_run("r1", ("tcp/127.0.0.1:5",)).endpoints.connect == ("tcp/127.0.0.1:5",)


def test_what_is_neither_name_nor_folder_is_refused_with_those_that_live(launch: Callable[..., Path]) -> None:
    with pytest.raises(ConfigError, match=r"for --run, got 'no/such'; live: none$"):
        choose_run("no/such")
    launch()
    with pytest.raises(ConfigError, match=r"got 'no/such'; live: r1 \(train"):
        choose_run("no/such")
