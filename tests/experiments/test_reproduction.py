"""The tables of the reproduction on small made-up rows, and pushes without learning."""

from typing import Any

import numpy as np
import pytest

from experiments.cells.leg_rule import LegRule, resolve, run
from experiments.rows import Made, Rows
from experiments.tables.reproduction import factorial, pictures, summaries
from experiments.tables.reproduction.tables import RULES, TRAININGS, rule_rows

STARTS = 3
MADE = Made(version="0", commit="0", command="")


def training(seed: int, error_m: float = 0.01, **settings: Any) -> dict[str, Any]:
    return {
        "seed": seed,
        "world": "map",
        "final_success": [error_m < 0.03] * STARTS,
        "final_position_error_m": [error_m] * STARTS,
        "final_angle_error_deg": [1.0, 2.0, 3.0],
        "final_n_cycles": [27] * STARTS,
        "nominal_position_error_m": error_m,
        "nominal_angle_error_deg": 1.0,
        "last_position_error_m": error_m,
        "last_success_rate": 1.0,
        "n_evaluated": 5,
        "episode_return": [-500.0] * 20 + [-300.0] * 40,
        "episode_position_error_m": [0.1] * 60,
        **settings,
    }


def all_cells() -> list[dict[str, Any]]:
    """Two seeds of each combination; the error says how many factors have the published level."""
    rows = []
    for ending in ("paper-text", "paper-learns", "release"):
        for frame in ("paper-text", "paper-learns"):
            for normalized in (False, True):
                for n_steps in (2048, 256):
                    levels = (ending, frame, normalized, n_steps)
                    n_published = sum(a == b for a, b in zip(levels, factorial.PRINTED, strict=True))
                    named = dict(zip(factorial.FACTORS, levels, strict=True))
                    rows += [training(seed, 0.01 + 0.1 * n_published, **named) for seed in (1, 2)]
    return rows


def test_the_interval_of_trainings_is_over_their_seeds() -> None:
    columns = summaries.training_columns([training(1, 0.01), training(2, 0.03)])

    assert (columns["n_seeds"], columns["n_starts"]) == (2, STARTS)
    assert (columns["position_error_m"], columns["position_error_m_n"]) == (pytest.approx(0.02), 2)
    assert columns["success"] == 0.5


def test_the_average_return_is_that_of_the_first_and_of_the_last_thirty_episodes() -> None:
    returns = [-500.0] * 30 + [-400.0] * 10 + [-300.0] * 30
    long, short = ({**training(seed, 0.01), "episode_return": some} for seed, some in ((1, returns), (2, returns[:29])))
    numbers = summaries.training_numbers([long, short])

    # A training of fewer episodes has no such average.
    assert (numbers["first_average_return"], numbers["final_average_return"]) == ([-500.0], [-300.0])


def test_a_cause_is_shown_alone_and_missing_alone() -> None:
    causes = factorial.causes(all_cells())

    assert list(causes) == list(factorial.NAMES)
    for name, found in causes.items():
        assert found["alone"]["position_error_m"]["value"] == pytest.approx(0.31)
        assert found["without"]["position_error_m"]["value"] == pytest.approx(0.11 if name == "frame" else 0.21)


def test_every_rung_of_the_ladder_is_named_and_has_its_trainings() -> None:
    names = ("profile", "observation", "reward", "actions", "ending", "entry")
    own = [[training(seed, **dict.fromkeys(names, place)) for place in range(9)] for seed in (1, 2)]

    rungs = factorial.rungs([row for seed in own for row in seed], all_cells())

    assert [change for change, _ in rungs] == list(factorial.CHANGES)
    assert {len(rows) for _, rows in rungs} == {2}
    assert [rows[0]["profile"] for _, rows in (*rungs[:5], *rungs[10:])] == list(range(9))


def test_levels_are_found_by_their_names() -> None:
    found = factorial.by_level(all_cells())

    assert found["paper-text"]["paper-text"]["raw"]["2048"]["position_error_m"]["value"] == pytest.approx(0.41)
    assert found["release"]["paper-learns"]["normalized"]["256"]["n_seeds"] == 2


def test_pictures_show_every_training() -> None:
    rows = [training(1, 0.01), training(2, 0.2)]
    ladder = [(change, rows) for change in factorial.CHANGES]

    drawn = [
        pictures.curves_figure(rows, rows),
        pictures.release_figure(rows),
        pictures.factorial_figure(all_cells()),
        pictures.ladder_figure(ladder),
    ]

    assert all(axis.lines for figure in drawn for axis in figure.axes)
    assert pictures.of_seeds_cm(rows).tolist() == pytest.approx([1.0, 20.0])


def test_episodes_without_learning_are_told_apart_by_rule_end_and_start() -> None:
    one = {"rule": "alternate", "ending": "release", "starts": "one"}
    studies = {name: Rows(rows=[one, {**one, "rule": "steering"}], made=MADE) for name in RULES}

    assert {levels: len(rows) for levels, rows in rule_rows(studies).items()} == {
        ("alternate", "release", "one"): len(RULES),
        ("steering", "release", "one"): len(RULES),
    }
    assert len(set(TRAININGS.values())) == len(TRAININGS)


def test_legs_by_the_steering_error_come_nearer_than_legs_in_turn_and_one_leg_gets_nowhere() -> None:
    ends = {
        rule: run(resolve(LegRule(rule=rule, seed=1, ending="paper-learns", world="map"), ()))
        for rule in ("steering", "alternate", "left")
    }

    assert [ends[rule]["how"] for rule in ends] == ["done", "done", "max_cycles"]
    errors_m = [ends[rule]["position_error_m"] for rule in ends]
    assert np.all(np.diff(errors_m) > 0.0)


def test_random_legs_follow_from_the_seed_and_the_published_rule_ends_earlier() -> None:
    cell = LegRule(rule="random", seed=3, starts="one", world="map")
    resolved = resolve(cell, ())

    assert run(resolved) == run(resolved) != run(resolve(LegRule(rule="random", seed=4, starts="one", world="map"), ()))
    assert resolved.task.scenario.randomization.box_xy_m == 0.0
    assert run(resolve(LegRule(rule="right", seed=3, starts="one", world="map"), ()))["success"] is False
