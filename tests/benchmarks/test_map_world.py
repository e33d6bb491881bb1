"""The world without physics against the simulator: policies, order, and errors in single pushes."""

from pathlib import Path

import numpy as np
import pytest
from msgspec.structs import replace

from agent_proc.policies.folder import read_policy
from agent_proc.profiles.profile import PpoProfile, load_profile
from benchmarks.map_world.agreement import MAPS, REAL, one_push, order, rank_correlation, report_of
from benchmarks.map_world.episodes import Episode, run
from benchmarks.map_world.policies import POLICIES
from benchmarks.map_world.speed import boxes_per_s
from benchmarks.map_world.transfer import Config, Learned, train
from benchmarks.map_world.transfer import report_of as report_of_trainings


def episode(policy: str, seed: int, world: str, error_m: float) -> Episode:
    return Episode(
        policy=policy,
        seed=seed,
        world=world,
        ending="done",
        position_error_m=error_m,
        angle_error_deg=100.0 * error_m,
        n_cycles=2,
        x_m=3.0,
        y_m=2.0 + error_m,
        yaw_deg=0.0,
        push_errors=((0.001, 0.0, 0.0), (-0.001, 0.002, 0.0)),
        within=(True, False),
    )


def test_all_ten_policies_push_in_the_map_until_they_are_done_or_have_no_push_left() -> None:
    ends = {name: run(name, 7, "map") for name in POLICIES}

    assert len(ends) == 10
    assert {name for name, end in ends.items() if end.ending != "done"} == {"one leg, 5 cm"}
    assert run("random legs, random depths", 7, "map") == ends["random legs, random depths"]
    assert ends["variable"].position_error_m < 0.01 < ends["alternate, 5 cm"].position_error_m


def test_without_residuals_the_map_has_no_error_in_its_own_pushes() -> None:
    errors = one_push([run("bang-bang, remaining depth", 7, "map_mean")])

    assert errors["n"] > 5
    assert max(*errors["rms"].values()) < 1e-6
    assert errors["within_95_percent"] == 1.0


def test_with_residuals_its_errors_are_those_that_its_covariance_allows() -> None:
    errors = one_push(run("random legs, random depths", seed, "map") for seed in range(20))

    assert errors["n"] > 400
    assert errors["within_95_percent"] == pytest.approx(0.95, abs=0.03)


def test_the_order_of_policies_tells_pairs_that_change_places() -> None:
    offsets = {"a": 0.01, "b": 0.02, "c": 0.05}
    mapped = {"a": 0.02, "b": 0.01, "c": 0.05}
    episodes = [
        episode(name, seed, world, errors[name] + 1e-4 * seed * (1 + len(world)))
        for world, errors in ((REAL, offsets), ("map", mapped))
        for name in offsets
        for seed in range(5)
    ]

    found = order(episodes, "map", "position_error_m")
    assert (found["simulator"], found["map"]) == (["a", "b", "c"], ["b", "a", "c"])
    assert found["spearman"]["value"] == pytest.approx(0.5)
    assert found["in_another_order"] == found["of_these_beyond_chance"] == [["a", "b"]]


def test_equal_tables_correlate_and_reversed_ones_do_not() -> None:
    table = np.random.default_rng(0).normal(np.arange(10.0), 0.1, (8, 10))

    same, reverse = rank_correlation(table, table), rank_correlation(table, -table)
    assert (same.value, same.low) == pytest.approx((1.0, 1.0))
    assert (reverse.value, reverse.high) == pytest.approx((-1.0, -1.0))
    assert same.n == 8


def test_a_report_compares_every_policy_in_both_maps() -> None:
    episodes = [
        episode(name, seed, world, 0.01 * (1 + seed) + offset)
        for offset, name in enumerate("abc")
        for seed in range(3)
        for world in (REAL, *MAPS)
    ]

    report = report_of(episodes)
    assert (report["n_policies"], report["n_starts"], report["n_episodes"]) == (3, 3, 9)
    assert report["one_push"]["all"]["n"] == 18
    assert report["one_push"]["all"]["rms"]["forward_mm"] == pytest.approx(1.0)
    end = report["worlds"]["map"]["policies"]["a"]
    assert end["ends_apart_m"] == {"median": 0.0, "largest": 0.0}
    assert end["position_error_m"]["map_minus_simulator"]["value"] == 0.0


def test_a_training_in_the_map_is_the_begin_of_another_one(tmp_path: Path) -> None:
    profile = load_profile("tuned")
    assert isinstance(profile, PpoProfile)
    small = replace(profile, steps=16, settings=replace(profile.settings, n_steps=8, batch_size=8))
    for name in ("first", "second"):
        (tmp_path / name).mkdir()

    assert train(small, "map", 1, tmp_path / "first") > 0.0
    assert train(small, "map", 1, tmp_path / "second", init=tmp_path / "first") > 0.0
    one, two = (read_policy(tmp_path / name / "last").layers[0].weight for name in ("first", "second"))
    assert not np.array_equal(one, two)
    assert np.abs(one - two).max() < 0.1


def test_trainings_count_as_groups() -> None:
    found = [
        Learned(
            variant=variant,
            seed=seed,
            cpu_s=1.0,
            position_error_m=(0.01, 0.03),
            angle_error_deg=(1.0, 1.0 + seed),
            success=(True, seed == 1),
        )
        for variant in ("simulator", "map")
        for seed in (1, 2)
    ]

    report = report_of_trainings(Config(n_trainings=2, n_starts=2), found)
    assert list(report["variants"]) == ["simulator", "map"]
    assert report["variants"]["map"]["position_error_m"]["value"] == pytest.approx(0.02)
    assert report["variants"]["map"]["angle_error_deg"]["n"] == 2
    assert report["variants"]["map"]["success_rate"]["value"] == pytest.approx(0.75)
    assert (report["steps"], len(report["trainings"])) == (5120, 4)


def test_many_boxes_are_pushed_at_once() -> None:
    assert boxes_per_s(100, 0) > 0.0
