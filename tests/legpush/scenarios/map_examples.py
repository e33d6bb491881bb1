"""One map that no mirror leaves as it is, in every kind of file."""

import struct
import zlib
from pathlib import Path
from typing import Any, Final

import numpy as np
import tomli_w
import yaml
from numpy.typing import NDArray
from PIL import Image

from legpush.scene.scenario import Rectangle

PICTURE: Final = """
....###.........
....#...........
....##..........
....#...........
................
................
................
................
................
................
"""
"""An F at the upper border of a room of 8 x 5 m, as it is seen from above with x to the right and y up."""
CELL_M: Final = 0.5
CELLS: Final[NDArray[np.uint8]] = np.array([[mark == "#" for mark in row] for row in PICTURE.split()], dtype=np.uint8)
"""Its rows from the top down."""
WALLS: Final = {(2.0, 2.5, 3.0, 3.5), (2.0, 3.0, 3.5, 4.0), (2.0, 2.5, 4.0, 4.5), (2.0, 3.5, 4.5, 5.0)}
"""Its walls, x_min, x_max, y_min and y_max in metres."""
OCCUPIED, FREE, UNKNOWN = 0, 254, 205
"""Grey values as `map_saver` writes them."""
ROS: Final[dict[str, Any]] = {
    "image": "map.pgm",
    "resolution": CELL_M,
    "origin": [0.0, 0.0, 0.0],
    "negate": 0,
    "occupied_thresh": 0.65,
    "free_thresh": 0.196,
}


def write_csv(path: Path, rows: NDArray[np.uint8]) -> None:
    path.write_text("".join(",".join(map(str, row)) + "\n" for row in rows.tolist()))


def write_pgm_ascii(path: Path, grey: NDArray[np.uint8]) -> None:
    rows = "\n".join(" ".join(map(str, row)) for row in grey.tolist())
    path.write_text(f"P2\n# as a person writes it\n{grey.shape[1]} {grey.shape[0]}\n255\n{rows}\n")


def write_pgm_binary(path: Path, grey: NDArray[np.uint8]) -> None:
    path.write_bytes(b"P5\n%d %d\n255\n" % grey.shape[::-1] + grey.tobytes())


def write_png(path: Path, pixels: NDArray[Any]) -> None:
    Image.fromarray(pixels).save(path, format="PNG")


GREY, COLOR, GREY_ALPHA, COLOR_ALPHA = 0, 2, 4, 6
"""Kinds of pixels as the header of a PNG names them."""


def png_of(samples: NDArray[Any], kind: int, *, n_bits: int = 8, hidden: list[int] | None = None) -> bytes:
    """The bytes of a PNG of these samples, (rows, columns, channels); `hidden` is the color that is transparent."""

    def chunk(name: bytes, content: bytes) -> bytes:
        return struct.pack(">I", len(content)) + name + content + struct.pack(">I", zlib.crc32(name + content))

    n_rows, n_columns = samples.shape[:2]
    if n_bits < 8:
        bits = np.unpackbits(samples.reshape(n_rows, -1, 1).astype(np.uint8), axis=-1)[..., -n_bits:]
        rows = np.packbits(bits.reshape(n_rows, -1), axis=-1)
    else:
        rows = samples.reshape(n_rows, -1).astype(f">u{n_bits // 8}").view(np.uint8)
    header = struct.pack(">IIBBBBB", n_columns, n_rows, n_bits, kind, 0, 0, 0)
    transparent = b"" if hidden is None else chunk(b"tRNS", struct.pack(f">{len(hidden)}H", *hidden))
    filtered = b"".join(b"\0" + row.tobytes() for row in rows)
    body = chunk(b"IHDR", header) + transparent + chunk(b"IDAT", zlib.compress(filtered)) + chunk(b"IEND", b"")
    return b"\x89PNG\r\n\x1a\n" + body


def write_yaml(path: Path, **changes: Any) -> None:
    """A map file that `map_server` takes; `changes` replaces fields, None drops one."""
    fields = ROS | changes
    path.write_text(yaml.safe_dump({key: value for key, value in fields.items() if value is not None}))


def write_scenario_of(folder: Path, room: dict[str, Any], **changes: Any) -> Path:
    """A scenario that has space around the F."""
    plain = {
        "name": "mapped",
        "room": room,
        "start": {"x_m": 1.0, "y_m": 1.0, "yaw_deg": 0.0},
        "box": {"pose": {"x_m": 5.5, "y_m": 2.5, "yaw_deg": 0.0}},
        "goal": {"pose": {"x_m": 6.5, "y_m": 2.5, "yaw_deg": 0.0}},
    }
    path = folder / "mapped.toml"
    path.write_text(tomli_w.dumps(plain | changes))
    return path


def sides(wall: Rectangle) -> tuple[float, float, float, float]:
    return wall.x_min_m, wall.x_max_m, wall.y_min_m, wall.y_max_m


def grey_of(cells: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """The picture of a map, black where it is occupied."""
    return np.where(cells == 1, OCCUPIED, FREE).astype(np.uint8)


def as_pgm_in_ascii(folder: Path) -> dict[str, Any]:
    write_pgm_ascii(folder / "map.pgm", grey_of(CELLS))
    write_yaml(folder / "map.yaml")
    return {"grid_file": "map.yaml"}


def as_pgm_in_binary(folder: Path) -> dict[str, Any]:
    write_pgm_binary(folder / "map.pgm", grey_of(CELLS))
    write_yaml(folder / "map.yml", negate=False, mode="trinary", author="ignored")
    return {"grid_file": "map.yml"}


def as_negative(folder: Path) -> dict[str, Any]:
    write_png(folder / "map.png", 255 - grey_of(CELLS))
    write_yaml(folder / "map.yaml", image="map.png", negate=1)
    return {"grid_file": "map.yaml"}
