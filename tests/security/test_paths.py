"""Scenarios and maps name files beside them or below, and no others."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from legpush.errors import ScenarioError
from legpush.recording.facts import scenario_in
from legpush.scenarios.file import copy_scenario, load_scenario
from tests.legpush.scenarios.map_examples import write_scenario_of

YAML = "image: {image}\nresolution: 1.0\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.2\n"
LEAVING: list[Callable[[Path, str], str]] = [
    lambda home, name: str(home.parent / name),
    lambda home, name: f"../{name}",
    lambda home, name: f"below/../../{name}",
    lambda home, name: f"link/{name}",
    lambda home, name: f"link_to_{name}",
]


@pytest.fixture
def home(tmp_path: Path) -> Path:
    """A folder with a good map in it, below it and beside it, and with links that leave it."""
    home = tmp_path / "home"
    (home / "below").mkdir(parents=True)
    for folder in (tmp_path, home, home / "below"):
        np.save(folder / "map.npy", np.zeros((8, 14), dtype=np.uint8))
        Image.fromarray(np.full((8, 14), 254, dtype=np.uint8)).save(folder / "map.png")
        (folder / "map.yaml").write_text(YAML.format(image="map.png"))
    (home / "link").symlink_to(tmp_path)
    for name in ("map.npy", "map.png", "map.yaml"):
        (home / f"link_to_{name}").symlink_to(tmp_path / name)
    return home


def scenario(home: Path, grid_file: str) -> Path:
    cells = {} if grid_file.endswith(".yaml") else {"cell_m": 1.0, "first_row": "top"}
    return write_scenario_of(home, {"grid_file": grid_file, **cells})


@pytest.mark.parametrize("grid_file", ["map.npy", "below/map.npy", "map.yaml", "below/map.yaml", "./below/map.yaml"])
def test_a_map_beside_the_scenario_or_below_it_is_read(home: Path, grid_file: str) -> None:
    assert load_scenario(scenario(home, grid_file)).room.size_m == (14.0, 8.0)


@pytest.mark.parametrize("name", ["map.npy", "map.yaml"])
@pytest.mark.parametrize("leaving", LEAVING)
def test_a_map_elsewhere_is_refused(home: Path, leaving: Callable[[Path, str], str], name: str) -> None:
    with pytest.raises(ScenarioError, match=r"at `room\.grid_file`: expected a file beside this one or in a folder"):
        load_scenario(scenario(home, leaving(home, name)))


@pytest.mark.parametrize("leaving", LEAVING)
def test_the_image_of_a_map_elsewhere_is_refused(home: Path, leaving: Callable[[Path, str], str]) -> None:
    (home / "map.yaml").write_text(YAML.format(image=leaving(home, "map.png")))

    with pytest.raises(ScenarioError, match=r"map\.yaml: at `image`: expected a file beside this one or in a folder"):
        load_scenario(scenario(home, "map.yaml"))


def test_the_scenario_of_a_recording_reads_no_file(home: Path) -> None:
    assert load_scenario(scenario(home, str(home / "map.npy"))).room.size_m == (14.0, 8.0)
    assert scenario_in(scenario(home, str(home / "map.npy")).read_bytes()) is None


def test_a_copy_of_a_scenario_writes_nothing_elsewhere(home: Path, tmp_path: Path) -> None:
    target = tmp_path / "other" / "inner"
    target.mkdir(parents=True)

    with pytest.raises(ScenarioError, match=r"at `room\.grid_file`"):
        copy_scenario(str(scenario(home, "../map.npy")), target / "small.toml")

    assert not list(tmp_path.glob("other/**/*.*"))
