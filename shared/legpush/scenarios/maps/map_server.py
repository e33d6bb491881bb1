"""Reads maps of ROS `map_server`: a YAML file and its image.

It reads them as `map_server` does: the darker a pixel, the more it is occupied, or the brighter with `negate`. The
first row of the image lies at the highest y. Versions of `map_server` differ in some pixels; a cell is free here only
if it is free in the current one of Nav2, whatever weights it gives to the colors.
"""

from importlib.resources.abc import Traversable
from pathlib import PurePath
from typing import Annotated, Any, Final, Literal

import numpy as np
from msgspec import Meta, Struct

from legpush.bounds import Coordinate, Resolution, Unit, Yaw
from legpush.errors import MessageError, ScenarioError
from legpush.messages.codec import convert
from legpush.scenarios.maps.map_files import OccupancyMap, file_inside
from legpush.scenarios.maps.map_image import read_image
from legpush.scenarios.maps.map_yaml import NO_YAML, RepeatedKeyError, plain_yaml
from legpush.schema_errors import explain

YAW_TOLERANCE_RAD: Final = 1e-6
"""A smaller yaw comes from rounding in the program that wrote the file."""
NUMERIC: Final = ("resolution", "origin", "negate", "occupied_thresh", "free_thresh")
"""Fields whose numbers may stand in quotes."""


class MapServerFile(Struct, frozen=True, kw_only=True):
    """The fields of the YAML file, with their names in the file; other fields are ignored."""

    image: Annotated[str, Meta(min_length=1)]
    """PGM, PNG, BMP or JPEG beside the YAML file, or below it."""
    resolution: Resolution
    """Metres per pixel."""
    origin: tuple[Coordinate, Coordinate, Yaw]
    """Lower left corner of the map in the map's frame, x and y in metres, and the map's yaw in radians."""
    negate: Annotated[int, Meta(ge=0, le=1)] | bool
    """Whether bright pixels are occupied."""
    occupied_thresh: Unit
    """A pixel at this value or above it is occupied."""
    free_thresh: Unit
    """A pixel below this value is free, and so is one of value 0 if this is 0. What is neither free nor occupied is
    unknown."""
    mode: Literal["trinary", "scale"] = "trinary"
    """How `map_server` grades unknown pixels; both are read alike. Capitals are taken, too."""


def read_map_server(folder: Traversable, name: str) -> OccupancyMap:
    """Return the map of a YAML file.

    Raises:
        ScenarioError: A file cannot be used; names the file and the field that is wrong.
    """
    fields = _read_yaml(folder / name)
    image = file_inside(folder / str(PurePath(name).parent), fields.image, f"{folder / name}: at `image`")
    pixels = read_image(image, f"{folder / name}: at `image`: {image}")
    occupied = np.zeros(pixels.clear.shape, dtype=np.bool_)
    free = np.zeros_like(occupied)
    for rows, darkness in pixels.darkness(negate=bool(fields.negate)):
        occupied[rows] = darkness >= fields.occupied_thresh
        free[rows] = (darkness < fields.free_thresh) | (darkness == 0.0)
    free &= ~occupied & ~pixels.clear
    unknown = ~free & (~occupied | pixels.clear)
    return OccupancyMap(
        occupied=~free[::-1],
        unknown=unknown[::-1],
        cell_m=fields.resolution,
        origin_m=fields.origin[:2],
    )


def _read_yaml(source: Traversable) -> MapServerFile:
    """Return the fields of the file, checked."""
    try:
        plain: Any = plain_yaml(source.read_bytes(), NUMERIC)
    except RepeatedKeyError as error:
        raise ScenarioError(f"{source}: {error}") from error
    except OSError as error:
        raise ScenarioError(f"{source}: expected a readable map file ({error.strerror})") from error
    except NO_YAML as error:
        raise ScenarioError(f"{source}: expected YAML ({' '.join(str(error).split())})") from error
    if isinstance(plain, dict) and isinstance(mode := plain.get("mode"), str):
        plain["mode"] = mode.lower()
    try:
        fields = convert(plain, MapServerFile)
    except MessageError as error:
        raise ScenarioError(f"{source}: {explain(str(error), plain, MapServerFile)}") from error
    if fields.free_thresh > fields.occupied_thresh:
        raise ScenarioError(
            f"{source}: at `free_thresh`: expected at most `occupied_thresh`, {fields.occupied_thresh}, "
            f"got {fields.free_thresh}"
        )
    if abs(fields.origin[2]) > YAW_TOLERANCE_RAD:
        raise ScenarioError(
            f"{source}: at `origin[2]`: expected a yaw of 0, since rooms lie along the axes, "
            f"got {fields.origin[2]} rad: turn the image instead"
        )
    return fields
