"""The tables of the levels: a few episodes, of which the numbers are known."""

from math import isnan
from typing import Any

import pytest

from experiments.rows import Row
from experiments.tables.benchmark import levels
from legpush.options.learning_tools import FIRST_HELD_OUT_SEED
from legpush.scenarios.file import load_scenario

GOAL = load_scenario("push").goal
ENDINGS = {
    "zero": ("max_cycles", "max_cycles", "fell", "done"),
    "script": ("done", "done", "done", "astray"),
    "variable": ("done", "done", "done", "done"),
    levels.ORACLE: ("done", "done"),
}
ERRORS_M = {
    "zero": (1.0, 1.0, 1.0, 0.06),
    "script": (0.01, 0.01, 0.02, 0.5),
    "variable": (0.01, 0.01, 0.01, 0.01),
    levels.ORACLE: (0.003, 0.003),
}


def episode(policy: str, start: int) -> Row:
    ending, error_m = ENDINGS[policy][start], ERRORS_M[policy][start]
    return {
        "policy": policy,
        "seed": FIRST_HELD_OUT_SEED + start,
        "ending": ending,
        "success": ending == "done" and error_m <= GOAL.position_tolerance_m,
        "position_error_m": error_m,
        "angle_error_deg": 0.0,
        "n_cycles": 10 + start,
        "simulated_s": 30.0,
        "decision_cpu_s": 0.001,
    }


def training(seed: int, errors_m: tuple[float, ...], **more: Any) -> Row:
    return {
        "seed": seed,
        "final_success": [error_m <= GOAL.position_tolerance_m for error_m in errors_m],
        "final_ended": ["done"] * len(errors_m),
        "final_position_error_m": list(errors_m),
        "final_angle_error_deg": [0.0] * len(errors_m),
        "final_n_cycles": [12] * len(errors_m),
        "final_simulated_s": [36.0] * len(errors_m),
        **more,
    }


RIVALS = [episode(policy, start) for policy, endings in ENDINGS.items() for start in range(len(endings))]


def test_the_best_rival_was_not_learned_and_is_no_oracle() -> None:
    found = levels.numbers_of(RIVALS, GOAL)

    assert (found["n"], found["best_rival"]) == (4, "script")
    assert found["minus_best_rival"].keys() == {"zero", "variable", levels.ORACLE}


def test_only_an_episode_that_the_policy_ended_within_the_tolerances_is_a_success() -> None:
    found = levels.numbers_of(RIVALS, GOAL)["policies"]

    assert {name: each["success"]["value"] for name, each in found.items()} == {
        "zero": 0.0,
        "script": 0.75,
        "variable": 1.0,
        levels.ORACLE: 1.0,
    }
    assert all(each["success"]["kind"] == "Wilson 95 %" for each in found.values())
    assert found["zero"]["endings"] == {"max_cycles": 2, "fell": 1, "done": 1}
    assert found["zero"]["n_cycles"]["value"] == 11.5
    assert found["script"]["loss"]["value"] == pytest.approx((2 * 1 / 3 + 2 / 3 + 10.0) / 4, abs=1e-6)


def test_a_start_is_solved_if_any_policy_succeeds_from_it() -> None:
    assert levels.numbers_of(RIVALS, GOAL)["n_solved"] == 4
    assert levels.numbers_of([row for row in RIVALS if row["policy"] in ("zero", "script")], GOAL)["n_solved"] == 3


def test_a_policy_with_fewer_starts_is_compared_on_those() -> None:
    found = levels.numbers_of(RIVALS, GOAL)

    assert found["policies"][levels.ORACLE]["n_starts"] == 2
    assert found["minus_best_rival"][levels.ORACLE]["position_error_m"]["value"] == pytest.approx(-0.007)
    assert found["minus_best_rival"][levels.ORACLE]["success"]["value"] == 0.0
    assert found["minus_best_rival"][levels.ORACLE]["probability_of_lower_loss"]["value"] == 1.0


def test_the_trainings_of_a_learner_are_one_line_and_have_no_time_of_a_decision() -> None:
    trainings = [
        training(1, (0.01, 0.01, 0.01, 0.01), profile="tuned"),
        training(2, (0.01, 0.01, 0.06, 0.06), profile="tuned"),
        training(1, (0.06, 0.06, 0.06, 0.06)),
    ]

    found = levels.numbers_of([*RIVALS, *levels.episodes_of(trainings)], GOAL)

    ppo = found["policies"]["ppo"]
    assert (ppo["n_trainings"], ppo["n_starts"], ppo["success"]["value"]) == (2, 4, 0.75)
    assert "decision_cpu_s" not in ppo
    assert found["policies"]["recurrent_ppo"]["success"]["value"] == 0.0
    assert found["minus_best_rival"]["ppo"]["success"]["value"] == 0.0


def test_an_episode_of_a_training_has_the_columns_of_the_others() -> None:
    (found,) = levels.episodes_of([training(3, (0.01,), profile="sac")])

    assert found.keys() == set(levels.COLUMNS[1:])
    assert (found["policy"], found["seed"]) == ("sac of seed 3", FIRST_HELD_OUT_SEED)
    assert isnan(found["decision_cpu_s"])


def test_every_policy_of_a_level_has_a_line_of_its_own() -> None:
    assert len(set(levels.STYLES.values())) == len(levels.STYLES)
    assert set(levels.LEARNERS.values()) <= levels.STYLES.keys()


def test_a_box_turns_both_ways_if_some_pushes_turn_it_to_either_side() -> None:
    rows: list[Row] = [{"turn_deg": turns} for turns in ([-3.0, 2.0], [4.0, 9.0], [-4.0, 0.2], [-9.0, -1.0, 0.6])]
    assert levels.turns_of(rows) == {"n_turned": 4, "n_turned_both_ways": 2}
