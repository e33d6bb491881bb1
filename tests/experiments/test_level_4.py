"""The table of level 4: shares of all rooms, measures and differences of those where the mission succeeded."""

from experiments.rows import Row
from experiments.tables.rooms.level_4 import numbers_of


def row(policy: str, seed: int, time_s: float, *, success: bool = True) -> Row:
    return {
        "policy": policy,
        "seed": seed,
        "success": success,
        "reason": "success" if success else "too_many_cycles",
        "sim_time_s": time_s,
        "n_push_cycles": int(time_s / 3),
        "box_position_error_m": 0.01,
        "box_angle_error_deg": 1.0,
    }


ROWS = [
    *(row("scripted", seed, 100.0 + seed) for seed in range(4)),
    *(row("dynamic_programming", seed, 90.0 + seed) for seed in range(4)),
    *(row("random", seed, 500.0, success=seed == 3) for seed in range(4)),
    *(row("variable", seed, 10.0) for seed in range(4)),
]


def test_the_best_rival_succeeds_most_often_in_the_least_time_and_did_not_learn() -> None:
    assert numbers_of(ROWS)["best_rival"] == "dynamic_programming"
    assert numbers_of([one for one in ROWS if one["policy"] != "dynamic_programming"])["best_rival"] == "scripted"


def test_failures_are_counted_by_reason_and_measures_are_of_successes() -> None:
    numbers = numbers_of(ROWS)
    assert numbers["n"] == 4
    blind = numbers["policies"]["random"]
    assert (blind["n"], blind["successes"], blind["failures"]) == (4, 1, "3 x too_many_cycles")
    assert blind["median_time_s"] == 500.0
    assert blind["sim_time_s"]["n"] == 1
    assert numbers["policies"]["scripted"]["failures"] == "none"


def test_differences_of_measures_are_those_of_rooms_in_which_both_succeed() -> None:
    less = numbers_of(ROWS)["minus_best_rival"]
    assert set(less) == {"scripted", "random", "variable"}
    assert less["random"]["success"]["value"] == -0.75
    assert (less["random"]["n_both"], less["random"]["sim_time_s"]["value"]) == (1, 500.0 - 93.0)
    assert (less["scripted"]["n_both"], less["scripted"]["sim_time_s"]["value"]) == (4, 10.0)


def test_a_policy_without_a_success_has_no_measures() -> None:
    rows = [*ROWS, *(row("zero", seed, 900.0, success=False) for seed in range(4))]
    numbers = numbers_of(rows)
    assert "sim_time_s" not in numbers["policies"]["zero"]
    assert numbers["minus_best_rival"]["zero"]["n_both"] == 0
