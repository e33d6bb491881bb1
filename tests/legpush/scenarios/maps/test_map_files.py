"""Maps in files: the same room from every kind, and what is refused with which words."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from legpush.errors import ScenarioError
from legpush.scenarios.file import load_scenario, load_with_map
from legpush.scenarios.grid import merged_cells
from legpush.scenarios.maps.map_files import read_cells
from tests.legpush.scenarios.map_examples import (
    CELL_M,
    CELLS,
    WALLS,
    as_negative,
    as_pgm_in_ascii,
    as_pgm_in_binary,
    grey_of,
    sides,
    write_csv,
    write_png,
    write_scenario_of,
    write_yaml,
)

BESIDE = {"cell_m": CELL_M}


def as_csv_from_the_top(folder: Path) -> dict[str, Any]:
    write_csv(folder / "map.csv", CELLS)
    return {"grid_file": "map.csv", "first_row": "top", **BESIDE}


def as_csv_from_the_bottom(folder: Path) -> dict[str, Any]:
    write_csv(folder / "map.csv", CELLS[::-1])
    return {"grid_file": "map.csv", "first_row": "bottom", **BESIDE}


def as_npy_from_the_top(folder: Path) -> dict[str, Any]:
    np.save(folder / "map.npy", CELLS)
    return {"grid_file": "map.npy", "first_row": "top", **BESIDE}


def as_npy_from_the_bottom(folder: Path) -> dict[str, Any]:
    np.save(folder / "map.npy", np.asfortranarray(CELLS[::-1].astype(np.bool_)))
    return {"grid_file": "map.npy", "first_row": "bottom", **BESIDE}


def as_pgm_of_16_bits(folder: Path) -> dict[str, Any]:
    grey = np.where(CELLS == 1, 300, 65535).astype(">u2")
    (folder / "map.pgm").write_bytes(b"P5\n16 10\n65535\n" + grey.tobytes())
    write_yaml(folder / "map.yaml")
    return {"grid_file": "map.yaml"}


def as_png(folder: Path) -> dict[str, Any]:
    write_png(folder / "map.png", grey_of(CELLS))
    write_yaml(folder / "map.yaml", image="map.png")
    return {"grid_file": "map.yaml"}


def as_png_in_another_folder(folder: Path) -> dict[str, Any]:
    (folder / "maps" / "images").mkdir(parents=True)
    write_png(folder / "maps" / "images" / "map.png", grey_of(CELLS))
    write_yaml(folder / "maps" / "map.yaml", image="images/map.png")
    return {"grid_file": "maps/map.yaml"}


def as_png_in_color(folder: Path) -> dict[str, Any]:
    write_png(folder / "map.png", np.repeat(grey_of(CELLS)[..., np.newaxis], 3, axis=-1))
    write_yaml(folder / "map.yaml", image=str(folder / "map.png"))
    return {"grid_file": "map.yaml"}


def as_png_of_16_bits(folder: Path) -> dict[str, Any]:
    write_png(folder / "map.png", np.where(CELLS == 1, 300, 65535).astype(np.uint16))
    write_yaml(folder / "map.yaml", image="map.png")
    return {"grid_file": "map.yaml"}


KINDS: tuple[Callable[[Path], dict[str, Any]], ...] = (
    as_csv_from_the_top,
    as_csv_from_the_bottom,
    as_npy_from_the_top,
    as_npy_from_the_bottom,
    as_pgm_in_ascii,
    as_pgm_in_binary,
    as_pgm_of_16_bits,
    as_png,
    as_png_in_another_folder,
    as_png_in_color,
    as_png_of_16_bits,
    as_negative,
)


def test_no_mirror_and_no_turn_leaves_the_map_as_it_is() -> None:
    square = CELLS[:, :10]
    turned = [np.rot90(square, quarter) for quarter in range(4)]
    assert len({cells.tobytes() for cells in (*turned, *(cells.T for cells in turned))}) == 8


@pytest.mark.parametrize("kind", KINDS)
def test_a_map_makes_the_same_room_in_every_kind_of_file(
    kind: Callable[[Path], dict[str, Any]], tmp_path: Path
) -> None:
    room = load_scenario(write_scenario_of(tmp_path, kind(tmp_path))).room
    assert room.size_m == (8.0, 5.0)
    assert {sides(wall) for wall in room.obstacles} == WALLS


def test_rectangles_in_the_scenario_make_that_room_too(tmp_path: Path) -> None:
    names = ("x_min_m", "x_max_m", "y_min_m", "y_max_m")
    listed = [dict(zip(names, wall, strict=True)) for wall in sorted(WALLS)]
    room = load_scenario(write_scenario_of(tmp_path, {"size_m": [8.0, 5.0], "obstacles": listed})).room
    from_file = load_scenario(write_scenario_of(tmp_path, as_png(tmp_path))).room
    assert (room.size_m, set(room.obstacles)) == (from_file.size_m, set(from_file.obstacles))


def test_the_published_map_has_the_wall_at_the_left_above_and_the_long_ones_below() -> None:
    _, occupancy = load_with_map("published")
    assert occupancy is not None
    assert occupancy.occupied[49:51, 1:15].all()
    assert not occupancy.occupied[49:51, 15:59].any()
    assert occupancy.occupied[9:11, 1:30].all()
    assert not occupancy.occupied[9:11, 30:59].any()


def test_a_lone_cell_lies_where_its_row_and_column_say(tmp_path: Path) -> None:
    cells = np.zeros((3, 4), dtype=np.uint8)
    cells[0, 1] = 1
    write_csv(tmp_path / "map.csv", cells)
    assert np.argwhere(read_cells(tmp_path / "map.csv", 1.0, "top").occupied).tolist() == [[2, 1]]
    assert np.argwhere(read_cells(tmp_path / "map.csv", 1.0, "bottom").occupied).tolist() == [[0, 1]]


def test_the_example_of_a_ros_map_is_a_scenario_in_the_frame_of_the_map() -> None:
    scenario, occupancy = load_with_map(Path(__file__).parents[4] / "examples" / "office" / "office.toml")
    assert occupancy is not None
    assert occupancy.unknown.any()
    assert (scenario.room.size_m, occupancy.origin_m) == ((10.0, 7.0), (-4.0, -2.5))
    assert (scenario.start.x_m, scenario.start.y_m) == pytest.approx((1.4, 1.7))
    wall = next(wall for wall in scenario.room.obstacles if wall.x_min_m == pytest.approx(3.0))
    assert sides(wall) == pytest.approx((3.0, 3.1, 0.5, 4.4))


def shifted(origin_m: tuple[float, float]) -> dict[str, Any]:
    """Start, box and goal as they stand in a frame in which the lower left corner is at `origin_m`."""
    x_m, y_m = origin_m
    return {
        "start": {"x_m": 1.0 + x_m, "y_m": 1.0 + y_m, "yaw_deg": 0.0},
        "box": {"pose": {"x_m": 5.5 + x_m, "y_m": 2.5 + y_m, "yaw_deg": 0.0}},
        "goal": {"pose": {"x_m": 6.5 + x_m, "y_m": 2.5 + y_m, "yaw_deg": 0.0}},
    }


def test_a_scenario_in_the_frame_of_the_map_is_the_one_in_the_frame_of_the_room(tmp_path: Path) -> None:
    as_pgm_in_ascii(tmp_path)
    origin_m = (-4.0, 16.0)
    write_yaml(tmp_path / "map.yaml", origin=[*origin_m, 0.0])
    pillar = {"x_min_m": 7.0, "x_max_m": 7.5, "y_min_m": 0.0, "y_max_m": 0.5}
    later = {"appears_at_s": 5.0}
    in_room = write_scenario_of(tmp_path, {"grid_file": "map.yaml", "obstacles": [pillar | later]})
    by_room, occupancy = load_with_map(in_room)
    pillar = {key: value + origin_m[key.startswith("y")] for key, value in pillar.items()}
    room = {"grid_file": "map.yaml", "frame": "map", "obstacles": [pillar | later]}
    assert load_scenario(write_scenario_of(tmp_path, room, **shifted(origin_m))) == by_room
    assert sides(by_room.room.obstacles[0]) == (7.0, 7.5, 0.0, 0.5)
    assert by_room.room.obstacles[0].appears_at_s == 5.0
    assert occupancy is not None
    assert occupancy.origin_m == origin_m


@pytest.mark.parametrize(
    ("room", "words"),
    [
        (
            {},
            r"at `start`: .*\(places are counted from the lower left corner of `map\.yaml`, \(10, 0\) .*= \"map\"",
        ),
        (
            {"frame": "map"},
            r"at `start`: .*\(places are counted from the lower left corner of `map\.yaml`, \(10, 0\) in",
        ),
    ],
)
def test_an_error_about_a_place_says_what_it_is_counted_from(room: dict[str, Any], words: str, tmp_path: Path) -> None:
    as_pgm_in_ascii(tmp_path)
    write_yaml(tmp_path / "map.yaml", origin=[10.0, 0.0, 0.0])
    start = {"x_m": 1.0 if room else 11.0, "y_m": 1.0, "yaw_deg": 0.0}
    with pytest.raises(ScenarioError, match=words):
        load_scenario(write_scenario_of(tmp_path, {"grid_file": "map.yaml", **room}, start=start))


@pytest.mark.parametrize(
    ("room", "words"),
    [
        (
            {"cell_m": 0.5},
            r"mapped\.toml:\d+: at `room\.cell_m`: expected nothing beside `map\.yaml`, which has it already",
        ),
        ({"first_row": "top"}, r"at `room\.first_row`: expected nothing beside `map\.yaml`, which has it already"),
        ({"size_m": [8.0, 5.0]}, r"at `room\.size_m`: expected nothing, since `room\.grid_file` has the size"),
        ({"frame": "odom"}, r"mapped\.toml:\d+: at `room\.frame`: expected one of map, room, got 'odom'"),
        (
            {"grid_file": "map.pgm"},
            r"expected a file that ends in \.csv, \.npy, .*got 'map\.pgm' \(for an image, name its",
        ),
        ({"grid_file": "no.yaml"}, r"no\.yaml: expected a readable map file \(No such"),
    ],
)
def test_a_room_says_nothing_that_its_map_says(room: dict[str, Any], words: str, tmp_path: Path) -> None:
    with pytest.raises(ScenarioError, match=words):
        load_scenario(write_scenario_of(tmp_path, as_pgm_in_ascii(tmp_path) | room))


def test_a_frame_needs_a_map(tmp_path: Path) -> None:
    with pytest.raises(ScenarioError, match=r"at `room\.grid_file`: expected a value, got nothing, beside frame"):
        load_scenario(write_scenario_of(tmp_path, {"size_m": [8.0, 5.0], "frame": "map"}))


def test_a_map_without_a_frame_of_its_own_takes_none(tmp_path: Path) -> None:
    with pytest.raises(
        ScenarioError, match=r"at `room\.frame`: expected nothing beside `map\.csv`, which has no frame"
    ):
        load_scenario(write_scenario_of(tmp_path, as_csv_from_the_top(tmp_path) | {"frame": "map"}))


NPY_ERRORS: dict[str, tuple[Any, str]] = {
    "three dimensions": (np.zeros((2, 3, 4), dtype=int), r"expected an array of 2 dimensions, .*, got 3 dimensions"),
    "a number": (np.array(1), r"expected an array of 2 dimensions, rows and columns, got 0 dimensions"),
    "floats": (np.zeros((2, 3)), r"expected an array of integers or truth values, got float64"),
    "texts": (np.array([["0", "1"]]), r"expected an array of integers or truth values, got <U1"),
    "objects": (np.array([[0, None]]), r"expected a NumPy file of one array without pickled objects \("),
    "other numbers": (np.array([[0, 1, 0], [1, 0, -1]]), r"expected 0 or 1 in row 2, column 3, got `-1`"),
    "no cells": (np.zeros((0, 3), dtype=int), r"expected 1 to 4096 rows and columns of cells, got none"),
    "too many": (np.zeros((4097, 1), dtype=bool), r"expected 1 to 4096 rows and columns of cells, got 4097 rows of 1"),
}


@pytest.mark.parametrize(("cells", "words"), NPY_ERRORS.values(), ids=NPY_ERRORS)
def test_a_bad_array_is_refused_with_what_it_is(cells: NDArray[Any], words: str, tmp_path: Path) -> None:
    np.save(tmp_path / "map.npy", cells, allow_pickle=True)
    with pytest.raises(ScenarioError, match=r"map\.npy: " + words):
        read_cells(tmp_path / "map.npy", 1.0, "top")


def npy_with_header(header: bytes) -> bytes:
    return b"\x93NUMPY\x01\x00" + len(header).to_bytes(2, "little") + header + bytes(8)


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"\x80\x04]\x94.",
        b"0,1\n",
        b"PK\x03\x04",
        b"\x93NUMPY\x01\x00\x10\x00{'descr': '<i8'",
        npy_with_header(b"{'descr': ("),
        npy_with_header(b"{'descr': '|u1', b'fortran_order': False, 'shape': (2, 4)}"),
        npy_with_header(b"{'descr': '|u1', 'fortran_order': False, 'shape': (%d, %d)}" % (10**18, 10**18)),
        npy_with_header(b"{'descr': '|u1', 'fortran_order': False, 'shape': (%d, 2)}" % 10**30),
    ],
)
def test_a_file_that_is_no_array_is_refused(content: bytes, tmp_path: Path) -> None:
    (tmp_path / "map.npy").write_bytes(content)
    with pytest.raises(ScenarioError, match=r"map\.npy: expected a NumPy file of one array without pickled objects"):
        read_cells(tmp_path / "map.npy", 1.0, "top")


def test_an_archive_of_arrays_is_refused(tmp_path: Path) -> None:
    np.savez(tmp_path / "map.npz", cells=CELLS)
    (tmp_path / "map.npz").rename(tmp_path / "map.npy")
    with pytest.raises(ScenarioError, match=r"expected an array of 2 dimensions, .* got an archive of arrays"):
        read_cells(tmp_path / "map.npy", 1.0, "top")


def test_a_map_of_more_rectangles_than_a_room_takes_is_refused_with_both_numbers(tmp_path: Path) -> None:
    cells = np.zeros((202, 202), dtype=np.uint8)
    cells[::2, ::2] = 1
    np.save(tmp_path / "map.npy", cells)
    pillar = {"x_min_m": 7.0, "x_max_m": 7.5, "y_min_m": 0.0, "y_max_m": 0.5}
    room = {"grid_file": "map.npy", "cell_m": 1.0, "first_row": "top", "obstacles": [pillar]}
    with pytest.raises(
        ScenarioError,
        match=r"at `room\.grid_file`: expected at most 10000 obstacles, .* `map\.npy` in 10201 rectangles and 1 in",
    ):
        load_scenario(write_scenario_of(tmp_path, room))


def test_the_largest_map_is_merged_into_the_rectangles_that_were_drawn() -> None:
    cells = np.zeros((4096, 4096), dtype=np.bool_)
    for k in range(64):
        cells[64 * k + 3 : 64 * k + 60, 64 * k : 64 * k + 40] = True
    assert merged_cells(cells).tolist() == [[64 * k + 3, 64 * k + 60, 64 * k, 64 * k + 40] for k in range(64)]
