"""The picture of a map: what can be seen in it, and where."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.colors import to_rgb
from PIL import Image

from agent_proc.reporting.map_picture import KEPT_CLEAR, UNKNOWN, is_own_picture, save_map_picture
from agent_proc.reporting.map_view import read_view
from agent_proc.reporting.style import BOX, GOAL, WALL
from legpush.arrays import Floats, Integers
from legpush.options.maps import MapOptions
from tests.legpush.scenarios.map_examples import CELLS, grey_of, write_csv, write_png, write_scenario_of, write_yaml
from tests.legpush.scenarios.map_examples import UNKNOWN as UNKNOWN_GREY


def drawn(file: Path, **flags: Any) -> Path:
    """The picture of a map, beside it."""
    picture = file.with_name("picture.png")
    save_map_picture(read_view(MapOptions(file=str(file), **flags)), picture)
    return picture


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


@pytest.mark.parametrize(("first_row", "quarter"), [("top", (0, 0)), ("bottom", (1, 0))])
def test_x_is_to_the_right_and_y_up(tmp_path: Path, first_row: str, quarter: tuple[int, int]) -> None:
    write_csv(tmp_path / "map.csv", CELLS)

    assert share_of(drawn(tmp_path / "map.csv", cell_m=0.5, first_row=first_row), WALL)[quarter] > 0.9


def test_unknown_cells_have_a_colour_of_their_own(tmp_path: Path) -> None:
    grey = grey_of(CELLS)
    grey[-2:, -4:] = UNKNOWN_GREY
    write_png(tmp_path / "map.png", grey)
    write_yaml(tmp_path / "map.yaml", image="map.png", origin=[-4.0, -2.5, 0.0])
    picture = drawn(tmp_path / "map.yaml")

    assert share_of(picture, WALL)[0, 0] > 0.9
    assert share_of(picture, UNKNOWN)[1, 1] > 0.7


def test_a_scenario_is_drawn_with_box_goal_and_what_the_trunk_keeps_clear(tmp_path: Path) -> None:
    np.save(tmp_path / "map.npy", CELLS)
    room = {"grid_file": "map.npy", "cell_m": 0.5, "first_row": "top"}
    scenario = write_scenario_of(tmp_path, room, goal={"pose": {"x_m": 6.5, "y_m": 3.5, "yaw_deg": 0.0}})
    picture = drawn(scenario)

    assert share_of(picture, WALL)[0, 0] > 0.9
    assert share_of(picture, GOAL)[0, 1] > 0.5
    assert pixels_of(picture, BOX).sum() > 100
    assert pixels_of(picture, KEPT_CLEAR).sum() > 10_000


def test_a_lone_cell_of_a_large_map_is_seen(tmp_path: Path) -> None:
    cells = np.zeros((4096, 4096), dtype=np.bool_)
    dark = []
    for occupied in (False, True):
        cells[1000, 1000] = occupied
        np.save(tmp_path / "map.npy", cells)
        dark.append(pixels_of(drawn(tmp_path / "map.npy", cell_m=0.05, first_row="top"), WALL))
    assert (dark[1] > dark[0]).tolist() == [[True, False], [False, False]]


def test_it_knows_its_own_pictures(tmp_path: Path) -> None:
    write_csv(tmp_path / "map.csv", CELLS)
    write_png(tmp_path / "plan.png", grey_of(CELLS))

    assert is_own_picture(drawn(tmp_path / "map.csv", cell_m=0.5, first_row="top"))
    assert not is_own_picture(tmp_path / "plan.png")
