"""Episodes of an evaluation: how they end, in which order they come, and their summary."""

import pytest

from agent_proc.evaluation.episodes import Row, evaluate, run_episode, summarize
from agent_proc.evaluation.sweep import make_sweep
from agent_proc.frames.push_view import PushView
from agent_proc.map_world.simulator import MapSimulator
from agent_proc.policies.registry import make_policy
from agent_proc.policies.scripted import ScriptedPolicy
from legpush.errors import MotionError
from legpush.lockstep.local import LocalWorld
from legpush.messages.stepping import Motion, Push
from legpush.scenarios.changes import override
from tests.agent.evaluation.rows import row
from tests.agent.fake_world import FakeWorld, scenario_at_station


class Always:
    """Pushes with the left leg for ever."""

    def decide(self, view: PushView) -> Push | None:
        """The same push each time."""
        return Push(w1=0.5, w2=0.5, leg="FL", depth_m=0.05)


def test_an_episode_of_the_scripted_policy_ends_at_the_goal() -> None:
    result = run_episode(FakeWorld(box_offset=(0.0, 0.03, 0.05)), scenario_at_station(), 5, ScriptedPolicy())

    assert (result.ending, result.success, result.seed) == ("done", True, 5)
    assert result.position_error_m < 0.03
    assert result.n_cycles > 5
    assert result.max_abs_roll_deg is not None
    assert result.max_abs_roll_deg > 0.1
    assert result.min_support_margin_m is not None
    assert 0.0 < result.min_support_margin_m < 0.06


def test_a_fall_ends_an_episode_without_success() -> None:
    world = FakeWorld(falls_in=lambda motion, n: isinstance(motion, Push) and n == 3)

    result = run_episode(world, scenario_at_station(), 0, Always())

    assert (result.ending, result.success, result.n_cycles) == ("fell", False, 3)


def test_an_episode_ends_after_the_cycles_of_the_scenario() -> None:
    scenario = override(scenario_at_station(), {"mission.max_push_cycles": 4})

    result = run_episode(FakeWorld(), scenario, 0, Always())

    assert (result.ending, result.n_cycles) == ("max_cycles", 4)


def test_a_box_out_of_reach_ends_an_episode_in_place_of_a_push_that_would_be_refused() -> None:
    scenario = override(scenario_at_station(), {"start.x_m": scenario_at_station().start.x_m - 0.3})

    result = run_episode(LocalWorld(MapSimulator()), scenario, 0, Always())

    assert (result.ending, result.success, result.n_cycles) == ("astray", False, 0)


def test_a_push_that_the_legs_cannot_follow_ends_an_episode() -> None:
    def refused(motion: Motion, n: int) -> bool:
        if isinstance(motion, Push) and n == 3:
            raise MotionError("Expected the curve of a push that the leg follows")
        return False

    result = run_episode(FakeWorld(falls_in=refused), scenario_at_station(), 0, Always())

    assert (result.ending, result.success, result.n_cycles) == ("refused", False, 2)


def test_an_episode_that_is_cut_off_is_no_success_wherever_the_box_is() -> None:
    scenario = override(scenario_at_station(), {"mission.max_push_cycles": 4, "goal.position_tolerance_m": 5.0})

    result = run_episode(FakeWorld(), scenario, 0, Always())

    assert result.position_error_m < 5.0
    assert (result.ending, result.success) == ("max_cycles", False)


@pytest.mark.parametrize("lost_depth_m", [0.0, 0.0035, 0.0135])
def test_an_episode_with_a_heavy_box_ends_by_itself(lost_depth_m: float) -> None:
    result = run_episode(FakeWorld(lost_depth_m=lost_depth_m), scenario_at_station(), 0, make_policy("variable"))

    assert (result.ending, result.success) == ("done", True)
    assert result.n_cycles < 60


def test_rows_come_in_the_order_of_cases_and_seeds_however_many_worlds_there_are() -> None:
    cases = make_sweep(scenario_at_station(), ["box.mass_kg=0.1,0.5"], grid=False).cases
    seen: list[Row] = []
    one, three = (
        evaluate([FakeWorld() for _ in range(n)], cases, range(3), ScriptedPolicy(), seen.append) for n in (1, 3)
    )

    assert one == three
    assert [(r.case, r.seed) for r in one] == [(c, s) for c in ("box.mass_kg=0.1", "box.mass_kg=0.5") for s in range(3)]
    assert seen[: len(one)] == one
    assert sorted(seen[len(one) :], key=three.index) == three


def test_the_summary_counts_falls_and_keeps_extremes() -> None:
    rows = [row(position_error_m=0.01), row(seed=1, position_error_m=0.03, ending="fell"), row(case="b", seed=0)]

    summaries = summarize(rows)

    assert list(summaries) == ["", "b"]
    assert (summaries[""].n, summaries[""].n_falls, summaries[""].success_rate.value) == (2, 1, 0.5)
    assert summaries[""].largest_position_error_m == 0.03
    assert summaries[""].position_error_m.value == pytest.approx(0.02)
