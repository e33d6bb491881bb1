"""The folder of a run: what is in it, and who may use it."""

from datetime import datetime
from pathlib import Path

import msgspec
import pytest

from legpush.errors import ConfigError
from legpush.runs.folder import default_folder, run_folder
from legpush.scenarios.file import load_scenario
from legpush.scene.scenario import Scenario


@pytest.fixture(scope="module")
def scenario() -> Scenario:
    return load_scenario("push")


def test_the_default_folder_says_when_what_and_with_which_seed(scenario: Scenario) -> None:
    assert default_folder(scenario, 7, datetime(2026, 3, 4, 5, 6, 7)) == Path("runs/20260304-050607-push-seed7")


def test_a_run_folder_holds_the_resolved_scenario_and_a_place_for_logs(scenario: Scenario, tmp_path: Path) -> None:
    folder = tmp_path / "deep" / "run"
    with run_folder(folder, scenario, private=False):
        assert load_scenario(folder / "scenario.toml") == scenario
        assert (folder / "logs").is_dir()


def test_an_empty_folder_may_be_used(scenario: Scenario, tmp_path: Path) -> None:
    with run_folder(tmp_path, scenario, private=False):
        assert (tmp_path / "scenario.toml").exists()


def test_the_folder_of_the_same_run_may_be_used_again(scenario: Scenario, tmp_path: Path) -> None:
    with run_folder(tmp_path, scenario, private=False):
        (tmp_path / "episode.journal").write_text("so far")
    with run_folder(tmp_path, scenario, private=False):
        assert (tmp_path / "episode.journal").read_text() == "so far"


def test_the_folder_of_a_run_of_another_scenario_is_refused_and_left_alone(scenario: Scenario, tmp_path: Path) -> None:
    with run_folder(tmp_path, scenario, private=False):
        pass
    other = msgspec.structs.replace(scenario, name="other")
    with (
        pytest.raises(ConfigError, match="expected a new folder, got that of a run of another scenario"),
        run_folder(tmp_path, other, private=False),
    ):
        pass
    assert load_scenario(tmp_path / "scenario.toml") == scenario


def test_a_folder_with_other_files_is_refused_and_left_alone(scenario: Scenario, tmp_path: Path) -> None:
    (tmp_path / "thesis.tex").touch()
    with pytest.raises(ConfigError, match="got one with other files"), run_folder(tmp_path, scenario, private=False):
        pass
    assert [path.name for path in tmp_path.iterdir()] == ["thesis.tex"]


def test_a_file_in_the_place_of_the_folder_is_refused(scenario: Scenario, tmp_path: Path) -> None:
    (tmp_path / "run").touch()
    with (
        pytest.raises(ConfigError, match=r"run: expected a folder that can be written to \(File exists\)"),
        run_folder(tmp_path / "run", scenario, private=False),
    ):
        pass


def test_two_launchers_never_share_a_folder(scenario: Scenario, tmp_path: Path) -> None:
    with (
        run_folder(tmp_path, scenario, private=False),
        pytest.raises(ConfigError, match="another launcher is running in it"),
        run_folder(tmp_path, scenario, private=False),
    ):
        pass
