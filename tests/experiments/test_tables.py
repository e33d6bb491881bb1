"""The tables in `results` are those that the rows give, and nothing else lies there."""

import json
from collections.abc import Callable

import pytest
from matplotlib.figure import Figure

from benchmarks.report import RESULTS as BENCHMARKS
from benchmarks.tables.__main__ import PICTURES as BENCHMARK_PICTURES
from benchmarks.tables.__main__ import TEXTS as BENCHMARK_TEXTS
from experiments.rows import RESULTS, read_rows
from experiments.tables import heavy_boxes, unseen
from experiments.tables.__main__ import PICTURES, TEXTS, Config, make
from experiments.tables.rooms import random_rooms
from experiments.tables.unknown_boxes import _name
from legpush.errors import ConfigError

Texts = Callable[[], dict[str, str]]
Pictures = Callable[[], dict[str, Figure]]
ALL = [(RESULTS, name, texts) for name, texts in TEXTS.items()]
ALL += [(BENCHMARKS, name, texts) for name, texts in BENCHMARK_TEXTS.items()]
FASTEST = ("straight_push", "handover", "references", "stability", "push_curves")
"""Pictures that are drawn here."""


@pytest.mark.parametrize(("folder", "name", "texts"), ALL, ids=[name for _, name, _ in ALL])
def test_the_tables_are_those_of_the_rows(folder, name: str, texts: Texts) -> None:  # type: ignore[no-untyped-def]
    for file, text in texts().items():
        assert (folder / file).read_text() == text, f"run `python -m {folder.parent.name}.tables {name}`"
        if file.endswith(".json"):
            assert all(made["commit"] and made["version"] for made in json.loads(text)["made"].values())


@pytest.mark.parametrize("name", FASTEST)
def test_a_picture_has_panels_with_lines(name: str) -> None:
    for figure in PICTURES[name]().values():
        assert figure.axes
        assert all(axis.lines or axis.containers for axis in figure.axes)


def test_every_picture_belongs_to_a_table() -> None:
    assert PICTURES.keys() <= TEXTS.keys()
    assert BENCHMARK_PICTURES.keys() <= BENCHMARK_TEXTS.keys()


def test_an_unknown_table_is_an_error_with_the_valid_ones() -> None:
    with pytest.raises(ConfigError, match=r"Expected tables among circles, .*, got squares"):
        make(Config(names=("squares",)), TEXTS, {}, RESULTS)


def test_a_case_is_named_by_what_the_trainings_lacked() -> None:
    usual = dict(unseen.AXES)

    assert unseen.case_of(usual) == "as trained"
    assert unseen.case_of(usual | {"box.size_m": [0.3, 0.58, 0.4], "box.friction": 0.8}) == (
        "box.friction=0.8 box.size_m=0.3x0.58x0.4"
    )


def test_a_robot_that_loses_its_balance_or_rolls_has_rocked() -> None:
    steady = {"within": True, "n_outside_support": 0, "max_abs_roll_deg": 1.9}

    assert heavy_boxes.kind_of(steady) == "reached"
    assert heavy_boxes.kind_of(steady | {"n_outside_support": 1}) == "rocks"
    assert heavy_boxes.kind_of(steady | {"max_abs_roll_deg": 2.1}) == "rocks"
    assert heavy_boxes.kind_of(steady | {"within": False}) == "not reached"


def test_a_box_is_named_by_what_differs_from_the_nominal_one() -> None:
    box = {"size_m": [0.4, 0.5, 0.4], "mass_kg": 0.1, "friction": 0.5, "shape": "cuboid"}

    assert _name(box) == "default"
    assert _name(box | {"mass_kg": 0.9, "friction": 0.3}) == "0.9 kg, friction 0.3"
    assert _name(box | {"shape": "cylinder", "size_m": [0.5, 0.5, 0.4]}) == "cylinder, 0.5 m"


def test_rooms_of_both_profiles_are_compared_room_by_room() -> None:
    first, *_ = read_rows("unseen_rooms").rows
    good, bad = first | {"success": True}, first | {"success": False, "reason": "stuck"}
    ideal = [row | {"realism.profile": "ideal", "seed": seed} for seed, row in enumerate((good, good, bad))]
    real = [row | {"realism.profile": "real", "seed": seed} for seed, row in enumerate((good, bad, good))]
    found = random_rooms.compare([*ideal, *real])
    assert (found["n_only_ideal"], found["n_only_real"]) == (1, 1)
    assert found["profiles"]["real"]["causes"] == {"stuck": 1}
    assert found["profiles"]["ideal"]["successes"] == 2
