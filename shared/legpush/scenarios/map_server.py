"""Reads maps of ROS `map_server`: a YAML file and its PGM or PNG image. The only module with Pillow and PyYAML.

It reads them as `map_server` does: the darker a pixel, the more it is occupied, or the brighter with `negate`. The
first row of the image lies at the highest y.
"""

import re
import struct
import warnings
from importlib.resources.abc import Traversable
from io import BytesIO
from pathlib import PurePath
from typing import Annotated, Any, Final, Literal

import numpy as np
import yaml
from msgspec import Meta, Struct
from numpy.typing import NDArray
from PIL import Image, UnidentifiedImageError

from legpush.arrays import Flags
from legpush.bounds import Coordinate, Resolution, Unit, Yaw
from legpush.errors import MessageError, ScenarioError
from legpush.messages.codec import convert
from legpush.scenarios.map_files import OccupancyMap, file_inside, require_side
from legpush.schema_errors import explain

YAW_TOLERANCE_RAD: Final = 1e-6
"""A smaller yaw comes from rounding in the program that wrote the file."""
DEEP_MODES: Final = ("I", "I;16", "I;16B", "I;16L", "I;16N")
"""Pillow's modes of images with grey values of 16 bits."""
DEEP_WHITE: Final = 65535
WHITE: Final = 255


NO_YAML: Final = (yaml.YAMLError, ValueError, RecursionError, LookupError, AttributeError, TypeError, OverflowError)
"""Errors that PyYAML raises for a damaged file, or for a value that is not what its tag says."""


class _Loader(yaml.SafeLoader):
    """Reads `5e-17` as a number, as ROS does; PyYAML alone reads it as text. Aliases are refused.

    A map needs no alias, and a short file with aliases of aliases stands for countless values.
    """

    def compose_node(self, parent: Any, index: Any) -> Any:
        """Compose the next value."""
        if self.check_event(yaml.AliasEvent):
            raise yaml.YAMLError("expected values, got an alias")
        return super().compose_node(parent, index)


_Loader.add_implicit_resolver(
    "tag:yaml.org,2002:float", re.compile(r"\A[-+]?[0-9]+[eE][-+]?[0-9]+\Z"), list("+-0123456789")
)


class MapServerFile(Struct, frozen=True, kw_only=True):
    """The fields of the YAML file, with their names in the file; other fields are ignored."""

    image: Annotated[str, Meta(min_length=1)]
    """PGM or PNG beside the YAML file, or below it."""
    resolution: Resolution
    """Metres per pixel."""
    origin: tuple[Coordinate, Coordinate, Yaw]
    """Lower left corner of the map in the map's frame, x and y in metres, and the map's yaw in radians."""
    negate: Annotated[int, Meta(ge=0, le=1)] | bool
    """Whether bright pixels are occupied."""
    occupied_thresh: Unit
    """A pixel above this value is occupied."""
    free_thresh: Unit
    """A pixel below this value is free. Between the thresholds, and on them, it is unknown."""
    mode: Literal["trinary", "scale"] = "trinary"
    """Use of transparency. `trinary`: one more channel of the average. `scale`: a pixel with any transparency is
    unknown."""


def read_map_server(folder: Traversable, name: str) -> OccupancyMap:
    """Return the map of a YAML file.

    Raises:
        ScenarioError: A file cannot be used; names the file and the field that is wrong.
    """
    fields = _read_yaml(folder / name)
    image = file_inside(folder / str(PurePath(name).parent), fields.image, f"{folder / name}: at `image`")
    values, white, clear = _read_image(image, f"{folder / name}: at `image`: {image}", fields.mode)
    brightness = np.arange(white + 1) / white
    darkness = brightness if fields.negate else np.arange(white, -1, -1) / white
    is_occupied = darkness > fields.occupied_thresh
    is_unknown = ~is_occupied & ~(darkness < fields.free_thresh)
    unknown = is_unknown[values] | clear
    return OccupancyMap(
        occupied=(is_occupied[values] | unknown)[::-1],
        unknown=unknown[::-1],
        cell_m=fields.resolution,
        origin_m=fields.origin[:2],
    )


def _read_yaml(source: Traversable) -> MapServerFile:
    """Return the fields of the file, checked."""
    try:
        plain: Any = _Loader(source.read_text(encoding="utf-8")).get_single_data()
    except OSError as error:
        raise ScenarioError(f"{source}: expected a readable map file ({error.strerror})") from error
    except NO_YAML as error:
        raise ScenarioError(f"{source}: expected YAML ({' '.join(str(error).split())})") from error
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


def _read_image(source: Traversable, where: str, mode: str) -> tuple[NDArray[np.uint16], int, Flags]:
    """Return the grey values in the order of the file, (rows, columns), the value of white, and a mask of that shape.

    The mask is True where transparency hides a pixel.
    """
    try:
        content = source.read_bytes()
    except OSError as error:
        raise ScenarioError(f"{where}: expected a readable image ({error.strerror})") from error
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", Image.DecompressionBombWarning)
            image = Image.open(BytesIO(content), formats=("PPM", "PNG"))
        require_side(image.height, image.width, where)
        image.load()
    except (OSError, SyntaxError, ValueError, EOFError, struct.error, Image.DecompressionBombError) as error:
        why = "neither" if isinstance(error, UnidentifiedImageError) else error
        raise ScenarioError(f"{where}: expected a whole PGM or PNG image ({why})") from error
    if image.mode in DEEP_MODES:
        grey = np.asarray(image).astype(np.uint16)
        return grey, DEEP_WHITE, np.zeros(grey.shape, dtype=np.bool_)
    channels = np.asarray(image.convert("RGBA" if image.has_transparency_data else "RGB"))
    clear = np.zeros(channels.shape[:2], dtype=np.bool_)
    if mode == "scale":
        clear |= (channels[..., 3:] < WHITE).any(axis=-1)
        channels = channels[..., :3]
    return channels.sum(axis=-1, dtype=np.uint16), WHITE * channels.shape[-1], clear
