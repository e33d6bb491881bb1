"""The formats that a recording can be exported to, and the cameras that films are seen from."""

from typing import Final, Literal

Format = Literal["foxglove", "csv", "parquet", "mp4", "gif", "urdf", "html"]
View = Literal["follow", "top", "room", "side", "front", "rear", "box", "orbit"]
ENDINGS: Final[dict[Format, str]] = {
    "foxglove": ".mcap",
    "csv": ".csv",
    "parquet": ".parquet",
    "mp4": ".mp4",
    "gif": ".gif",
    "urdf": ".urdf",
    "html": ".html",
}
PICTURES: Final = (".png", ".svg", ".pdf")
"""Endings of pictures; the last two are vector files."""
FILMS: Final[tuple[Format, ...]] = ("mp4", "gif")
LARGEST_FRAME: Final = (3840, 2160)
FASTEST_GIF_FPS: Final = 50.0
"""Fastest rate that viewers show; the time between frames is a whole number of hundredths of a second."""
