"""Images of maps: every kind of pixel at its full depth, and no cell that is freer than a reading of `map_server`."""

from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from legpush.scenarios.maps.map_image import BLOCK_ROWS, MapImage, read_image
from legpush.scenarios.maps.map_server import read_map_server
from tests.legpush.scenarios.map_examples import COLOR, COLOR_ALPHA, GREY, GREY_ALPHA, png_of, write_yaml

MEAN = (Fraction(1, 3),) * 3
LUMA = (Fraction(212656, 10**6), Fraction(715158, 10**6), Fraction(72186, 10**6))
"""What the versions of `map_server` weigh red, green and blue with."""
Pixel = tuple[int, int, int, int]
LEVELS = st.one_of(st.sampled_from([0, 1, 204, 205, 254, 255]), st.integers(0, 255))
PIXELS = st.lists(
    st.one_of(
        st.tuples(LEVELS, LEVELS, LEVELS, st.sampled_from([0, 128, 254, 255])),
        LEVELS.map(lambda level: (level, level, level, 255)),
    ),
    min_size=1,
    max_size=12,
)
THRESHOLDS = st.tuples(*[st.one_of(st.sampled_from([0.0, 0.196, 0.2, 0.65, 1.0]), st.floats(0.0, 1.0))] * 2).map(sorted)


def mark_of(pixel: Pixel, weights: tuple[Fraction, ...], *, negate: bool, free: float, occupied: float) -> str:
    """What one version makes of a pixel, with thresholds that are exclusive, except that nothing is below 0."""
    bright = sum((w * Fraction(level, 255) for w, level in zip(weights, pixel[:3], strict=True)), Fraction(0))
    darkness = float(bright if negate else 1 - bright)
    if pixel[3] < 255:
        return "?"
    if darkness >= occupied:
        return "#"
    return "." if darkness < free or darkness == 0.0 == free else "?"


@given(pixels=PIXELS, thresholds=THRESHOLDS, negate=st.booleans(), mode=st.sampled_from(["trinary", "Scale"]))
def test_a_cell_is_free_exactly_where_every_reading_calls_it_free(
    pixels: list[Pixel], thresholds: list[float], negate: bool, mode: str, tmp_path_factory: pytest.TempPathFactory
) -> None:
    free, occupied = thresholds
    folder = tmp_path_factory.getbasetemp() / "readings"
    folder.mkdir(exist_ok=True)
    (folder / "map.png").write_bytes(png_of(np.array([pixels]), COLOR_ALPHA))
    fields = {"negate": int(negate), "mode": mode, "occupied_thresh": occupied, "free_thresh": free}
    write_yaml(folder / "map.yaml", image="map.png", **fields)
    found = read_map_server(folder, "map.yaml")
    for column, pixel in enumerate(pixels):
        marks = {mark_of(pixel, w, negate=negate, free=free, occupied=occupied) for w in (MEAN, LUMA)}
        assert found.occupied[0, column] == (marks != {"."})
        assert found.unknown[0, column] == ("#" not in marks and marks != {"."})


def read(folder: Path, content: bytes) -> MapImage:
    (folder / "map.image").write_bytes(content)
    return read_image(folder / "map.image", "map.image")


@pytest.mark.parametrize("kind", [GREY, COLOR, GREY_ALPHA, COLOR_ALPHA])
@pytest.mark.parametrize("n_bits", [8, 16])
def test_every_kind_of_png_gives_its_samples_at_full_depth(kind: int, n_bits: int, tmp_path: Path) -> None:
    n_channels = {GREY: 1, COLOR: 3, GREY_ALPHA: 2, COLOR_ALPHA: 4}[kind]
    white = 2**n_bits - 1
    samples = np.random.default_rng(kind).integers(0, white + 1, (5, 7, n_channels))
    samples[0] = white
    if kind in (GREY_ALPHA, COLOR_ALPHA):
        samples[1, :, -1] = white - 1
    image = read(tmp_path, png_of(samples, kind, n_bits=n_bits))
    n_colors = n_channels - (kind in (GREY_ALPHA, COLOR_ALPHA))
    assert image.white == white
    assert image.colors.tolist() == samples[..., :n_colors].tolist()
    assert image.clear.tolist() == (samples[..., n_colors:] < white).any(axis=-1).tolist()


ONE_HIDDEN: list[tuple[int, int, list[int]]] = [
    (GREY, 1, [1]),
    (GREY, 2, [3]),
    (GREY, 4, [9]),
    (GREY, 8, [200]),
    (GREY, 16, [51400]),
    (COLOR, 8, [7, 8, 9]),
    (COLOR, 16, [1, 2, 3]),
]
"""Kind of pixels, bits, and the transparent color."""


@pytest.mark.parametrize(("kind", "n_bits", "hidden"), ONE_HIDDEN)
def test_the_color_that_a_png_names_as_transparent_is_clear(
    kind: int, n_bits: int, hidden: list[int], tmp_path: Path
) -> None:
    samples = np.zeros((2, 3, len(hidden)), dtype=np.int64)
    samples[1, 2] = hidden
    samples[0, 1] = np.array(hidden) ^ 1
    clear = read(tmp_path, png_of(samples, kind, n_bits=n_bits, hidden=hidden)).clear
    assert np.argwhere(clear).tolist() == [[1, 2]]


def test_a_palette_with_a_transparent_color_is_clear_there(tmp_path: Path) -> None:
    picture = Image.fromarray(np.array([[0, 1, 2]], dtype=np.uint8)).convert("P")
    picture.putdata([0, 1, 2])
    picture.putpalette([0, 0, 0, 254, 254, 254, 255, 255, 255])
    picture.save(tmp_path / "map.png", transparency=1)
    image = read(tmp_path, (tmp_path / "map.png").read_bytes())
    assert image.clear.tolist() == [[False, True, False]]
    assert image.colors[0, :, 0].tolist() == [0, 254, 255]


@pytest.mark.parametrize("name", ["map.bmp", "map.jpeg", "map.png", "map.pgm", "map.ppm"])
@pytest.mark.parametrize("mode", ["1", "L", "RGB"])
def test_every_format_gives_the_same_picture(name: str, mode: str, tmp_path: Path) -> None:
    grey = np.repeat(np.array([[0, 255], [255, 255], [0, 255]], dtype=np.uint8), 16, axis=1).repeat(16, axis=0)
    if (name, mode) == ("map.jpeg", "1"):
        mode = "L"
    Image.fromarray(grey).convert(mode).save(tmp_path / name)
    image = read(tmp_path, (tmp_path / name).read_bytes())
    assert (image.colors == grey[..., np.newaxis]).all()
    assert not image.clear.any()


def test_a_tall_map_is_dark_where_its_pixels_are(tmp_path: Path) -> None:
    grey = np.random.default_rng(0).integers(0, 256, (2 * BLOCK_ROWS + 3, 2, 1))
    image = read(tmp_path, png_of(grey, GREY))
    blocks = list(image.darkness(negate=False))
    assert len(blocks) == 3
    darkness = np.empty(grey.shape[:2])
    for rows, block in blocks:
        darkness[rows] = block
    assert (darkness == (255 - grey[..., 0]) / 255).all()
