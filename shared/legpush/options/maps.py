"""Options of `legpush map` and `legpush picture`."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from legpush.arguments import USUAL_OUTPUT, OutputOptions, Positional, arg
from legpush.bounds import Resolution
from legpush.errors import ConfigError
from legpush.fields import require
from legpush.options.checks import require_new_file, require_picture_ending
from legpush.options.scenarios import Changes
from legpush.scenarios.maps.map_formats import CELL_SUFFIXES, IMAGE_SUFFIXES, MAP_SERVER_SUFFIXES, FirstRow, suffix_of


@dataclass(frozen=True, kw_only=True)
class MapOptions:
    """Draw a map from above as legpush reads it, x to the right and y up, and print a description of it.

    A scenario is drawn as the planner gets it, with start, box, goal and the zone that the trunk keeps clear.
    Exit codes: 0 drawn, 2 bad input.
    """

    file: Positional[Annotated[str, arg("NAME|FILE")]]
    """A built-in scenario, a scenario file, the YAML file of a ROS map, or a grid of 0 and 1 in a .csv or .npy file."""
    changes: Changes = ()
    """Change a field of the scenario, such as room.size_m=8x6; may be given several times."""
    out: Annotated[Path | None, arg("FILE")] = None
    """The picture: .png, .svg or .pdf; `<name>_map.png` in the working directory if not given. It may replace only a
    PNG that this command made."""
    cell_m: Annotated[float | None, arg("M")] = None
    """Side of a cell; required for .csv and .npy files, which do not have it."""
    first_row: Annotated[FirstRow | None, arg()] = None
    """Place of the first row of a .csv or .npy file: at the highest y, or at y = 0."""
    output: OutputOptions = USUAL_OUTPUT

    def __post_init__(self) -> None:
        """Check that the flags fit the type of the file.

        Raises:
            ConfigError: They do not.
        """
        suffix = suffix_of(self.file)
        if suffix in IMAGE_SUFFIXES:
            valid = " or ".join(MAP_SERVER_SUFFIXES)
            raise ConfigError(f"{self.file}: expected a map with its scale; for an image, name its {valid} file")
        if self.changes and suffix in (*CELL_SUFFIXES, *MAP_SERVER_SUFFIXES):
            raise ConfigError(f"{self.file}: expected --set only with a scenario")
        for flag, value in (("--cell-m", self.cell_m), ("--first-row", self.first_row)):
            if value is None and suffix in CELL_SUFFIXES:
                raise ConfigError(f"{self.file}: expected --cell-m and --first-row, which a {suffix} file lacks")
            if value is not None and suffix not in CELL_SUFFIXES:
                raise ConfigError(f"{self.file}: expected {flag} only with {' and '.join(CELL_SUFFIXES)} files")
        require(Resolution, self.cell_m, "--cell-m")
        if self.out is not None:
            require_picture_ending(self.out, "--out")
            if not self.out.parent.is_dir():
                raise ConfigError(f"Expected a file in an existing folder for --out, got {self.out}")

    def picture(self) -> Path:
        """Return the path of the picture."""
        return Path(f"{Path(self.file).stem}_map.png") if self.out is None else self.out


@dataclass(frozen=True, kw_only=True)
class PictureOptions:
    """Draw the picture of a mission again, for example as a vector file for a paper.

    Exit codes: 0 drawn, 2 bad input.
    """

    run_folder: Positional[Annotated[Path, arg("DIR")]]
    """The folder of the run, with its journal and its report."""
    out: Annotated[Path | None, arg("FILE")] = None
    """The new picture: .png, .svg or .pdf; `mission.svg` in the folder of the run if not given."""
    output: OutputOptions = USUAL_OUTPUT

    def __post_init__(self) -> None:
        """Check that the picture can be written.

        Raises:
            ConfigError: It cannot.
        """
        require_picture_ending(self.target(), "--out")
        if not self.run_folder.is_dir():
            raise ConfigError(f"Expected the folder of a run for DIR, got {self.run_folder}")
        require_new_file(self.target(), "--out")

    def target(self) -> Path:
        """Return the path of the picture."""
        return self.run_folder / "mission.svg" if self.out is None else self.out
