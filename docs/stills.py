"""`python -m docs.stills`: the two pictures of README that are frames of a film, from the mission that README shows.

The mission runs as `make run` runs it, and its film is drawn without a caption.
"""

import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

import imageio_ffmpeg

FOLDER: Final = Path(__file__).parent
FRAMES_S: Final = {"walking.jpg": 5.0, "pushing.jpg": 17.2}
"""When each picture is in the film, in seconds of the film."""


def main() -> int:
    """Run the mission, film it, and write the pictures."""
    with TemporaryDirectory() as scratch:
        run = Path(scratch) / "mission"
        _legpush("run", "default", "--no-picture", "--no-video", "--quiet", "--out", str(run))
        _legpush("render", str(run), "--no-caption")
        for name, at_s in FRAMES_S.items():
            _take_frame(run / "mission.mp4", at_s, FOLDER / name)
    return 0


def _legpush(*words: str) -> None:
    subprocess.run(["legpush", *words], check=True)


def _take_frame(film: Path, at_s: float, picture: Path) -> None:
    """Write the frame of a film at this time."""
    words = ["-loglevel", "error", "-y", "-ss", f"{at_s:g}", "-i", str(film), "-frames:v", "1", "-q:v", "4"]
    subprocess.run([imageio_ffmpeg.get_ffmpeg_exe(), *words, str(picture)], check=True)


if __name__ == "__main__":
    sys.exit(main())
