"""Every study file of the experiments and benchmarks can be run with the command that the list of studies gives."""

import importlib.util
import re
from pathlib import Path

import pytest

from docs.study_list import FOLDERS, ROOT, command_of, study_list
from legpush.study.file import Study, load_study

FILES = [path for folder in FOLDERS for path in sorted((ROOT / folder).glob("*.toml"))]
TRAINED_BEFORE = "unseen_randomized"
"""This study needs a policy that another study trains."""
NEEDS_BENCH = [path.stem for path in FILES if "extra `bench`" in path.read_text()]


def study(path: Path) -> Study:
    cell = re.search(r"--cell (\S+)", command_of(path))
    return load_study(path, own_cell=cell[1] if cell else None)


def test_there_are_studies_of_experiments_and_of_benchmarks() -> None:
    assert {path.parents[1].name for path in FILES} == {"experiments", "benchmarks"}
    assert len(FILES) > 20


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_a_study_has_the_name_of_its_file_and_its_last_cell_can_be_made(path: Path) -> None:
    found = study(path)

    assert found.file.name == path.stem
    if path.stem != TRAINED_BEFORE:
        assert found.task(found.n_cells - 1).specification


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_the_list_of_studies_says_what_a_study_does_and_how_long_it_takes(path: Path) -> None:
    (line,) = (
        line for line in study_list(path.relative_to(ROOT).parent.as_posix()).splitlines() if command_of(path) in line
    )

    what, time, _ = line.strip("| ").split(" | ")
    assert what.endswith(".")
    assert re.fullmatch(r"\d+ (s|min|h)", time)


def test_random_rooms_and_hand_overs_have_the_same_first_rooms() -> None:
    rooms, handovers = (
        study(ROOT / "experiments" / "studies" / f"{name}.toml") for name in ("random_rooms", "handover")
    )

    first = [rooms.values(index) for index in range(24)]
    last = [handovers.values(handovers.n_cells - 24 + index) for index in range(24)]
    assert [room.items() <= handover.items() for room, handover in zip(first, last, strict=True)] == [True] * 24


def test_the_planners_of_other_projects_are_asked_only_with_the_extra_bench() -> None:
    assert NEEDS_BENCH == ["planner_peers", "planner_peers_pure", "planner_peers_until"]
    assert importlib.util.find_spec("benchmarks.planners.peers") is not None
