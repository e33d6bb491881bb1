"""`python -m experiments.tables [NAME ...]`: makes all tables and pictures from the rows of the studies.

The tables are CSV files for people and JSON files for the documentation, in `experiments/results/`. Each JSON file says
with which version and commit its rows were made. `python -m docs.generate` puts the numbers into the pages.
"""

import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Final

import tyro
from rich.progress import track

from agent_proc.figures import Figure, own_style, save_figure
from experiments.rows import RESULTS
from experiments.tables import (
    circles,
    heavy_boxes,
    learning,
    learning_pictures,
    mass_sweep,
    missions,
    push_effect,
    references,
    straight_push,
    unknown_boxes,
    unseen,
    walking,
)
from experiments.tables.benchmark import levels, starts
from experiments.tables.paper import (
    learns,
    mass_trend,
    push_curves,
    push_pictures,
    robot_pictures,
    stability,
    turn_rate,
)
from experiments.tables.reproduction import pictures as reproduction_pictures
from experiments.tables.reproduction import tables as reproduction
from experiments.tables.rooms import docking, handover, level_4, random_rooms
from legpush.errors import ConfigError
from legpush.files import write_whole
from legpush.service import run_program

TEXTS: Final[dict[str, Callable[[], dict[str, str]]]] = {
    "circles": circles.texts,
    "docking": docking.texts,
    "handover": handover.texts,
    "heavy_boxes": heavy_boxes.texts,
    "learning": learning.texts,
    "learns": learns.texts,
    "level_4": level_4.texts,
    "levels": levels.texts,
    "mass_sweep": mass_sweep.texts,
    "mass_trend": mass_trend.texts,
    "missions": missions.texts,
    "push_curves": push_curves.texts,
    "push_effect": push_effect.texts,
    "random_rooms": random_rooms.texts,
    "references": references.texts,
    "reproduction": reproduction.texts,
    "stability": stability.texts,
    "starts": starts.texts,
    "straight_push": straight_push.texts,
    "turn_rate": turn_rate.texts,
    "unknown_boxes": unknown_boxes.texts,
    "unseen": unseen.texts,
    "walking": walking.texts,
}
"""Functions that return the contents of tables by the names of their files."""
PICTURES: Final[dict[str, Callable[[], dict[str, Figure]]]] = {
    "circles": circles.pictures,
    "handover": handover.pictures,
    "heavy_boxes": heavy_boxes.pictures,
    "learning": learning_pictures.pictures,
    "levels": levels.pictures,
    "mass_sweep": mass_sweep.pictures,
    "push_curves": push_pictures.pictures,
    "random_rooms": random_rooms.pictures,
    "references": references.pictures,
    "reproduction": reproduction_pictures.pictures,
    "stability": robot_pictures.pictures,
    "starts": starts.pictures,
    "straight_push": straight_push.pictures,
    "unknown_boxes": unknown_boxes.pictures,
    "unseen": unseen.pictures,
}
"""The same for pictures."""


@dataclass(frozen=True, kw_only=True)
class Config:
    """What to make."""

    names: Annotated[tyro.conf.Positional[tuple[str, ...]], tyro.conf.arg(metavar="NAME")] = ()
    """Names of tables; if not given, all."""
    pictures: bool = True
    """Also draw the pictures."""


def main(config: Config) -> int:
    """Make tables and pictures."""
    make(config, TEXTS, PICTURES, RESULTS)
    return 0


def make(
    config: Config,
    texts: Mapping[str, Callable[[], dict[str, str]]],
    pictures: Mapping[str, Callable[[], dict[str, Figure]]],
    folder: Path,
) -> None:
    """Write tables and pictures into a folder.

    Raises:
        ConfigError: There is no such table, or it has no rows.
    """
    if unknown := [name for name in config.names if name not in texts]:
        raise ConfigError(f"Expected tables among {', '.join(texts)}, got {', '.join(unknown)}")
    for name in track(config.names or tuple(texts), description="tables"):
        for file, text in texts[name]().items():
            write_whole(folder / file, text.encode())
        if config.pictures and name in pictures:
            with own_style({"text.parse_math": True}):
                for file, figure in pictures[name]().items():
                    save_figure(figure, folder / file)


if __name__ == "__main__":
    sys.exit(run_program("tables", lambda: main(tyro.cli(Config))))
