"""Maps of ROS's map server: what pixels mean, and what is refused with which words."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from legpush.errors import ScenarioError
from legpush.scenarios.file import load_scenario
from legpush.scenarios.maps.map_files import OccupancyMap
from legpush.scenarios.maps.map_server import read_map_server
from tests.legpush.scenarios.map_examples import (
    FREE,
    UNKNOWN,
    as_pgm_in_binary,
    write_png,
    write_scenario_of,
    write_yaml,
)


def pixels_read(folder: Path, pixels: NDArray[Any], **changes: Any) -> str:
    """What one row of pixels is taken for: `#` occupied, `?` unknown, `.` free."""
    write_png(folder / "map.png", pixels[np.newaxis])
    write_yaml(folder / "map.yaml", image="map.png", **changes)
    return marks(read_map_server(folder, "map.yaml"))


def marks(occupancy: OccupancyMap) -> str:
    (occupied,), (unknown,) = occupancy.occupied.tolist(), occupancy.unknown.tolist()
    return "".join("?" if u else "#" if o else "." for o, u in zip(occupied, unknown, strict=True))


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({}, "##??.."),
        ({"free_thresh": 0.25}, "##?..."),
        ({"negate": 1}, ".??###"),
        ({"occupied_thresh": 0.2, "free_thresh": 0.2}, "####.."),
        ({"occupied_thresh": 1.0, "free_thresh": 0.0}, "#????."),
        ({"occupied_thresh": 1.0, "free_thresh": 0.0, "negate": True}, ".????#"),
        ({"occupied_thresh": 1.0, "free_thresh": 1.0}, "#....."),
        ({"occupied_thresh": 0.0, "free_thresh": 0.0}, "######"),
    ],
)
def test_at_the_upper_threshold_a_pixel_is_occupied_and_below_the_lower_one_it_is_free(
    changes: dict[str, Any], expected: str, tmp_path: Path
) -> None:
    grey = np.array([0, 88, 153, 204, FREE, 255], dtype=np.uint8)
    assert pixels_read(tmp_path, grey, **{"occupied_thresh": 0.65, "free_thresh": 0.2} | changes) == expected


def test_what_map_saver_leaves_unknown_is_unknown_and_counts_as_occupied(tmp_path: Path) -> None:
    grey = np.array([UNKNOWN, FREE], dtype=np.uint8)
    assert pixels_read(tmp_path, grey) == "?."
    assert read_map_server(tmp_path, "map.yaml").occupied.tolist() == [[True, False]]


def test_a_color_is_as_dark_as_its_mean_or_its_luma_whichever_is_darker(tmp_path: Path) -> None:
    colors = np.array([[255, 0, 0], [255, 255, 0], [255, 255, 240], [20, 10, 0], [255, 180, 255]], dtype=np.uint8)
    assert pixels_read(tmp_path, colors) == "#?.#?"


@pytest.mark.parametrize("mode", ["trinary", "scale", "Trinary", "SCALE"])
def test_opaque_pixels_count_by_their_color_and_others_are_unknown(mode: str, tmp_path: Path) -> None:
    colors = [[254, 254, 254, 255], [205, 205, 205, 255], [254, 254, 254, 0], [254, 254, 254, 254]]
    colors += [[0, 0, 0, 0], [0, 0, 0, 255]]
    assert pixels_read(tmp_path, np.array(colors, dtype=np.uint8), mode=mode) == ".????#"


def edit_yaml(**changes: Any) -> Callable[[Path], None]:
    return lambda folder: write_yaml(folder / "map.yaml", **changes)


def put_bytes(name: str, content: bytes) -> Callable[[Path], None]:
    def put(folder: Path) -> None:
        (folder / name).write_bytes(content)

    return put


def png_without_its_end(folder: Path) -> None:
    noise = np.random.default_rng(0).integers(0, 256, (64, 64), dtype=np.uint8)
    write_png(folder / "map.pgm", noise)
    (folder / "map.pgm").write_bytes((folder / "map.pgm").read_bytes()[:2000])


ROS_ERRORS: dict[str, tuple[Callable[[Path], None], str]] = {
    "no image": (edit_yaml(image="no.pgm"), r"map\.yaml: at `image`: .*no\.pgm: expected a readable image \(No such"),
    "image not named": (edit_yaml(image=None), r"map\.yaml: at `image`: expected a value, got nothing"),
    "no YAML": (put_bytes("map.yaml", b"image: [map.pgm"), r"map\.yaml: expected YAML \(while parsing a flow sequence"),
    "YAML of a list": (put_bytes("map.yaml", b"- 1"), r"map\.yaml: at `the top`: expected a table, got an array"),
    "empty YAML": (put_bytes("map.yaml", b""), r"map\.yaml: at `the top`: expected a table, got"),
    "YAML with an object": (
        put_bytes("map.yaml", b"!!python/object/apply:os.getpid []"),
        r"map\.yaml: expected YAML \(",
    ),
    "YAML without end": (put_bytes("map.yaml", b"[" * 5000), r"map\.yaml: expected YAML \("),
    "YAML that is no text": (put_bytes("map.yaml", b"\xff\xfe\x00"), r"map\.yaml: expected YAML \("),
    "a key twice": (
        put_bytes("map.yaml", b"image: map.pgm\nresolution: 1\nimage: map.pgm\n"),
        r"map\.yaml: at `image`: expected the key once, got it in line 1 and in line 3",
    ),
    "resolution in words": (edit_yaml(resolution="fine"), r"at `resolution`: expected a number, got a text 'fine'"),
    "resolution 0": (edit_yaml(resolution=0), r"at `resolution`: expected a number from 0\.001 to 100, got 0"),
    "resolution without end": (
        edit_yaml(resolution=float("inf")),
        r"at `resolution`: expected a finite number, got inf",
    ),
    "origin of two": (edit_yaml(origin=[0.0, 0.0]), r"at `origin`: expected an array of length 3, got 2"),
    "yaw": (edit_yaml(origin=[0.0, 0.0, 0.5]), r"at `origin\[2\]`: expected a yaw of 0, .* got 0\.5 rad"),
    "threshold above 1": (
        edit_yaml(occupied_thresh=65),
        r"at `occupied_thresh`: .* from 0 to 1, got 65",
    ),
    "thresholds crossed": (
        edit_yaml(free_thresh=0.7),
        r"at `free_thresh`: expected at most `occupied_thresh`, 0\.65, got 0\.7",
    ),
    "no threshold": (edit_yaml(free_thresh=None), r"at `free_thresh`: expected a value, got nothing"),
    "negate 2": (edit_yaml(negate=2), r"at `negate`: expected a whole number from 0 to 1, got 2"),
    "mode raw": (edit_yaml(mode="raw"), r"at `mode`: expected one of scale, trinary, got 'raw'"),
    "truncated PNG": (png_without_its_end, r"map\.pgm: expected a whole PGM, PNG, BMP or JPEG image \("),
    "truncated PGM": (
        put_bytes("map.pgm", b"P5\n16 10\n255\n" + bytes(9)),
        r"expected a whole PGM, PNG, BMP or JPEG image \(image",
    ),
    "letters in a PGM": (
        put_bytes("map.pgm", b"P2\n2 1\n255\n0 x\n"),
        r"map\.pgm: expected a whole PGM, PNG, BMP or JPEG image \(",
    ),
    "an image of another format": (
        put_bytes("map.pgm", b"GIF89a" + bytes(20)),
        r"a whole PGM, PNG, BMP or JPEG image \(none of them\)",
    ),
    "image too wide": (
        put_bytes("map.pgm", b"P5\n4097 1\n255\n" + bytes(4097)),
        r"map\.pgm: expected 1 to 4096 rows and columns of cells, got 1 rows of 4097",
    ),
    "image of a billion pixels": (
        put_bytes("map.pgm", b"P5\n40000 40000\n255\n"),
        r"map\.pgm: expected a whole PGM, PNG, BMP or JPEG image \(.*exceeds limit",
    ),
}


@pytest.mark.parametrize(("spoil", "words"), ROS_ERRORS.values(), ids=ROS_ERRORS)
def test_a_bad_map_of_ros_is_refused_with_file_and_field(
    spoil: Callable[[Path], None], words: str, tmp_path: Path
) -> None:
    path = write_scenario_of(tmp_path, as_pgm_in_binary(tmp_path) | {"grid_file": "map.yaml"})
    write_yaml(tmp_path / "map.yaml")
    assert load_scenario(path).name == "mapped"
    spoil(tmp_path)
    with pytest.raises(ScenarioError, match=words):
        load_scenario(path)
