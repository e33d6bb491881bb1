import pytest

from agent_proc.studies.cell_parts import path_changes, planner, policy_with, scenario_of, sha256_of_policy
from legpush.errors import PolicyError, ScenarioError
from legpush.scenarios.file import load_scenario


def test_a_scenario_gets_its_changes_and_a_start_that_fits_the_box() -> None:
    changed = scenario_of("push", {"box.mass_kg": 0.5, "box.size_m": [0.2, 0.5, 0.4]})
    assert (changed.box.mass_kg, changed.box.size_m) == (0.5, (0.2, 0.5, 0.4))
    assert changed.start.x_m == pytest.approx(load_scenario("push").start.x_m + 0.1, abs=0.02)


def test_a_change_that_cannot_be_used_is_refused() -> None:
    with pytest.raises(ScenarioError, match="mass_kg"):
        scenario_of("push", {"box.mass_kg": -1.0})


def test_only_the_settings_of_paths_that_were_given_are_changes() -> None:
    assert path_changes("rrt_star", None, 0.5) == {"planning.planner": "rrt_star", "planning.min_turning_radius_m": 0.5}


def test_a_policy_that_runs_code_has_to_be_allowed() -> None:
    own = "tests.agent.parts:no_such_policy"
    with pytest.raises(PolicyError, match=f"The policy {own} runs code: repeat it with --policy {own} if you trust it"):
        sha256_of_policy(own, ())
    assert sha256_of_policy(own, (own,))
    assert sha256_of_policy("scripted", ()) == ""


def test_a_policy_with_other_files_than_the_study_had_is_refused() -> None:
    with pytest.raises(PolicyError, match="Expected the policy variable with the SHA-256 0123, got one with"):
        policy_with("variable", "0123")


def test_cells_share_a_policy_of_this_package() -> None:
    assert policy_with("scripted", "") is policy_with("scripted", "")


def test_the_planner_is_the_installed_one() -> None:
    assert planner().__module__ == "planner_proc.planning"
