"""`legpush map show`: what it says, and what can be seen in the picture."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.colors import to_rgb
from PIL import Image

from agent_proc.programs.show_map import run
from agent_proc.reporting.map_picture import KEPT_CLEAR, UNKNOWN
from agent_proc.reporting.style import BOX, GOAL, WALL
from legpush.arrays import Floats, Integers
from legpush.errors import ConfigError, LegpushError
from legpush.options.maps import MapOptions
from tests.legpush.scenarios.map_examples import CELLS, grey_of, write_csv, write_png, write_scenario_of, write_yaml
from tests.legpush.scenarios.map_examples import UNKNOWN as UNKNOWN_GREY


def options(file: str | Path, **flags: Any) -> MapOptions:
    return MapOptions(action="show", file=str(file), **flags)


def pixels_of(picture: Path, color: str) -> Integers:
    """How many of a colour lie in the quarters of a picture, (2, 2), the upper ones first."""
    with Image.open(picture) as image:
        pixels = np.asarray(image.convert("RGB"), dtype=int)
    found = np.abs(pixels - np.round(255 * np.array(to_rgb(color)))).max(axis=-1) <= 1
    height, width = (side // 2 for side in found.shape)
    quarters: Integers = found[: 2 * height, : 2 * width].reshape(2, height, 2, width).sum(axis=(1, 3))
    assert quarters.any()
    return quarters


def share_of(picture: Path, color: str) -> Floats:
    """The same as shares of all pixels with that colour."""
    quarters = pixels_of(picture, color)
    return quarters / float(quarters.sum())


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A working directory of its own."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_the_picture_has_x_to_the_right_and_y_up(here: Path) -> None:
    write_csv(here / "map.csv", CELLS)
    for first_row, (row, column) in (("top", (0, 0)), ("bottom", (1, 0))):
        run(options("map.csv", cell_m=0.5, first_row=first_row))
        assert share_of(here / "map_map.png", WALL)[row, column] > 0.9, first_row


def test_a_map_of_ros_says_where_its_frame_is_and_what_is_unknown(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    grey = grey_of(CELLS)
    grey[-2:, -4:] = UNKNOWN_GREY
    write_png(here / "map.png", grey)
    write_yaml(here / "map.yaml", image="map.png", origin=[-4.0, -2.5, 0.0])
    assert run(options("map.yaml")) == 0
    assert capsys.readouterr().out.splitlines() == [
        "size        8 x 5 m",
        "cells       16 x 10 of 0.5 m",
        "origin      (0, 0) is the lower left corner, x to the right, y up",
        "map frame   the room's plus (-4, -2.5): there the corner is (-4, -2.5)",
        "occupied    9.4% of the cells, in 5 rectangles",
        "unknown     5.0% of the file's cells, which count as occupied",
        "wrote map_map.png",
    ]
    assert share_of(here / "map_map.png", WALL)[0, 0] > 0.9
    assert share_of(here / "map_map.png", UNKNOWN)[1, 1] > 0.7


def test_a_scenario_is_drawn_with_box_goal_and_what_the_trunk_keeps_clear(here: Path) -> None:
    np.save(here / "map.npy", CELLS)
    room = {"grid_file": "map.npy", "cell_m": 0.5, "first_row": "top"}
    run(options(write_scenario_of(here, room, goal={"pose": {"x_m": 6.5, "y_m": 3.5, "yaw_deg": 0.0}})))
    picture = here / "mapped_map.png"
    assert share_of(picture, WALL)[0, 0] > 0.9
    assert share_of(picture, GOAL)[0, 1] > 0.5
    assert pixels_of(picture, BOX).sum() > 100
    assert pixels_of(picture, KEPT_CLEAR).sum() > 10_000


def test_a_lone_cell_of_a_large_map_is_seen(here: Path) -> None:
    cells = np.zeros((4096, 4096), dtype=np.bool_)
    dark = []
    for occupied in (False, True):
        cells[1000, 1000] = occupied
        np.save(here / "map.npy", cells)
        run(options("map.npy", cell_m=0.05, first_row="top"))
        dark.append(pixels_of(here / "map_map.png", WALL))
    assert (dark[1] > dark[0]).tolist() == [[True, False], [False, False]]


def test_a_map_of_too_many_rectangles_is_shown_and_said_to_be_no_room(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    cells = np.zeros((202, 202), dtype=np.bool_)
    cells[::2, ::2] = True
    np.save(here / "map.npy", cells)
    assert run(options("map.npy", cell_m=0.05, first_row="top")) == 0
    assert "25.0% of the cells, in 10201 rectangles: more than the 10000 of a room\n" in capsys.readouterr().out


def test_only_a_picture_of_its_own_is_overwritten(here: Path) -> None:
    write_csv(here / "map.csv", CELLS)
    write_png(here / "plan.png", grey_of(CELLS))
    before = (here / "plan.png").read_bytes()
    for _ in range(2):
        assert run(options("map.csv", cell_m=0.5, first_row="top")) == 0
    with pytest.raises(ConfigError, match=r"plan\.png: expected a new file for --output, or a picture of `legpush map"):
        run(options("map.csv", cell_m=0.5, first_row="top", output=Path("plan.png")))
    assert (here / "plan.png").read_bytes() == before


def test_nothing_is_drawn_of_a_map_that_cannot_be_read(here: Path) -> None:
    (here / "map.yaml").write_text("image: map.pgm")
    with pytest.raises(LegpushError, match=r"map\.yaml: at `resolution`: expected a value, got nothing"):
        run(options("map.yaml"))
    (here / "folder.png").mkdir()
    with pytest.raises(ConfigError, match=r"folder\.png: expected a file for --output \(Is a directory\)"):
        run(options("default", output=Path("folder.png")))
    assert sorted(path.name for path in here.iterdir()) == ["folder.png", "map.yaml"]
