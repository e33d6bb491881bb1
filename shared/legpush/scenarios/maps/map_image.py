"""Reads the images of maps: PGM, PNG, BMP and JPEG. The only module with Pillow."""

import struct
import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.resources.abc import Traversable
from io import BytesIO
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageFile, PngImagePlugin, UnidentifiedImageError

from legpush.arrays import Flags, Floats
from legpush.errors import ScenarioError
from legpush.scenarios.maps.map_files import require_side

FORMATS: Final = ("PPM", "PNG", "BMP", "JPEG")
"""Pillow's names of the formats; `PPM` includes PGM."""
DEEP_MODES: Final = ("I", "I;16", "I;16B", "I;16L", "I;16N")
"""Pillow's modes of images with grey values of 16 bits."""
DEEP_WHITE: Final = 65535
WHITE: Final = 255
LOW_BYTES: Final = {"RGB;16B": "RGB;16L", "RGBA;16B": "RGBA;16L"}
"""PNG layouts of 16-bit colors, of which Pillow reads the high bytes, to the layouts that read the low ones."""
GREY_AND_ALPHA: Final = "LA;16B"
FULL_SCALE: Final = {"L;2": 85, "L;4": 17}
"""Factor from grey values of 2 and 4 bits, in which a PNG names its transparent one, to those of 8 bits."""
READINGS: Final = ((1, 1, 1), (212656, 715158, 72186))
"""Weights of red, green and blue in the brightness of a color: the mean, and the luma of Rec. 709. Versions of
`map_server` differ in which of them they take."""
BLOCK_ROWS: Final = 256
"""Rows that are computed at once, so that a large map takes little memory."""


@dataclass(frozen=True, kw_only=True, eq=False)
class MapImage:
    """Pixels in the order of the file, the first row at the top."""

    colors: NDArray[Any]
    """Grey values, (rows, columns, 1), or red, green and blue, (rows, columns, 3)."""
    white: int
    """Value of full brightness."""
    clear: Flags
    """Pixels that are not fully opaque, (rows, columns)."""

    def darkness(self, *, negate: bool) -> Iterator[tuple[slice, Floats]]:
        """Yield a block of rows and how occupied its pixels are, from 0 to 1, (rows, columns).

        A pixel is as dark as its darkest reading says, or with `negate` as bright as its brightest.
        """
        weights = np.array(READINGS if self.colors.shape[-1] > 1 else ((1,),))
        full = weights.sum(axis=-1) * self.white
        for first in range(0, len(self.colors), BLOCK_ROWS):
            rows = slice(first, first + BLOCK_ROWS)
            brightness = self.colors[rows].astype(np.int64) @ weights.T
            yield rows, ((brightness if negate else full - brightness) / full).max(axis=-1)


def read_image(source: Traversable, where: str) -> MapImage:
    """Return the pixels of a file.

    Raises:
        ScenarioError: The file cannot be used; begins with `where`.
    """
    try:
        content = source.read_bytes()
    except OSError as error:
        raise ScenarioError(f"{where}: expected a readable image ({error.strerror})") from error
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", Image.DecompressionBombWarning)
            image = Image.open(BytesIO(content), formats=FORMATS)
        require_side(image.height, image.width, where)
        return _pixels(image, content)
    except (OSError, SyntaxError, ValueError, EOFError, struct.error, Image.DecompressionBombError) as error:
        why = "none of them" if isinstance(error, UnidentifiedImageError) else error
        raise ScenarioError(f"{where}: expected a whole PGM, PNG, BMP or JPEG image ({why})") from error


def _pixels(image: Image.Image, content: bytes) -> MapImage:
    """Return the pixels of an open image; `content` is its file."""
    layout = str(image.tile[0][3]) if isinstance(image, ImageFile.ImageFile) and image.format == "PNG" else ""
    white = DEEP_WHITE if image.mode in DEEP_MODES or layout in (*LOW_BYTES, GREY_AND_ALPHA) else WHITE
    image.load()
    hidden = image.info.pop("transparency", None) if image.mode != "P" else None
    channels = _channels(image, content, layout)
    n_colors = 3 if channels.shape[-1] > 2 else 1
    colors = channels[..., :n_colors]
    clear = np.any(channels[..., n_colors:] < white, axis=-1)
    if hidden is not None:
        clear = clear | np.all(colors == np.multiply(hidden, FULL_SCALE.get(layout, 1)), axis=-1)
    return MapImage(colors=colors, white=white, clear=clear)


def _channels(image: Image.Image, content: bytes, layout: str) -> NDArray[Any]:
    """Return the samples of a loaded image, (rows, columns, channels): colors, then alpha if there is one."""
    if layout == GREY_AND_ALPHA:
        as_bytes = _in_layout(content, "RGBA").astype(np.uint16)
        return as_bytes[..., ::2] << 8 | as_bytes[..., 1::2]
    if layout in LOW_BYTES:
        return np.asarray(image).astype(np.uint16) << 8 | _in_layout(content, LOW_BYTES[layout])
    if image.mode in DEEP_MODES:
        return np.asarray(image).astype(np.uint16)[..., np.newaxis]
    if image.mode == "1":
        image = image.convert("L")
    elif image.mode not in ("L", "LA", "RGB", "RGBA"):
        image = image.convert("RGBA" if image.has_transparency_data else "RGB")
    return np.asarray(image).reshape(image.height, image.width, -1)


def _in_layout(content: bytes, layout: str) -> NDArray[np.uint8]:
    """Return the bytes of a PNG that are read as this layout, (rows, columns, channels)."""
    image = PngImagePlugin.PngImageFile(BytesIO(content))
    image.tile = [image.tile[0]._replace(args=layout)]
    return np.asarray(image)
