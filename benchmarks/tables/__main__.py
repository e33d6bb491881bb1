"""`python -m benchmarks.tables [NAME ...]`: makes the tables and pictures of the benchmarks that are studies."""

import sys
from collections.abc import Callable
from typing import Final

import tyro

from agent_proc.figures import Figure
from benchmarks.report import RESULTS
from benchmarks.tables import box_paths, collisions, compare, peers
from experiments.tables.__main__ import Config, make
from legpush.service import run_program

TEXTS: Final[dict[str, Callable[[], dict[str, str]]]] = {
    "box_paths": box_paths.texts,
    "planner_collisions": collisions.texts,
    "planner_compare": compare.texts,
    "planner_peers": peers.texts,
}
"""Functions that return the contents of tables by the names of their files."""
PICTURES: Final[dict[str, Callable[[], dict[str, Figure]]]] = {
    "planner_compare": compare.pictures,
    "planner_peers": peers.pictures,
}
"""The same for pictures."""


def main(config: Config) -> int:
    """Make tables and pictures."""
    make(config, TEXTS, PICTURES, RESULTS)
    return 0


if __name__ == "__main__":
    sys.exit(run_program("tables", lambda: main(tyro.cli(Config))))
