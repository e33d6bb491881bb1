"""Evaluation: episodes, sweeps and statistics."""

import csv
import io
from pathlib import Path

import pytest
from pyarrow import parquet

from agent_proc.evaluation.episodes import Row, evaluate, run_episode, summarize
from agent_proc.evaluation.plot import save_plot
from agent_proc.evaluation.sweep import make_sweep
from agent_proc.evaluation.table import as_csv, table, write_parquet
from agent_proc.frames.push_view import PushView
from agent_proc.policies.scripted import ScriptedPolicy
from agent_proc.statistics import mean_interval, wilson
from legpush.messages.stepping import Push
from legpush.scenarios.file import override
from tests.agent.fake_world import FakeWorld, scenario_at_station


class Always:
    """Pushes with the left leg for ever."""

    def decide(self, view: PushView) -> Push | None:
        """The same push each time."""
        return Push(w1=0.5, w2=0.5, leg="FL", depth_m=0.05)


def row(case: str = "", seed: int = 0, position_error_m: float = 0.01, ending: str = "done") -> Row:
    """An episode."""
    return Row(
        case=case,
        seed=seed,
        ending=ending,  # type: ignore[arg-type]
        success=ending == "done",
        position_error_m=position_error_m,
        angle_error_deg=1.0,
        n_cycles=20,
        max_abs_roll_deg=0.5,
        max_abs_pitch_deg=0.7,
        min_support_margin_m=0.02,
    )


def test_an_episode_of_the_scripted_policy_ends_at_the_goal() -> None:
    result = run_episode(FakeWorld(box_offset=(0.0, 0.03, 0.05)), scenario_at_station(), 5, ScriptedPolicy())

    assert (result.ending, result.success, result.seed) == ("done", True, 5)
    assert result.position_error_m < 0.03
    assert result.n_cycles > 5
    assert result.max_abs_roll_deg > 0.1
    assert 0.0 < result.min_support_margin_m < 0.06


def test_a_fall_ends_an_episode_without_success() -> None:
    world = FakeWorld(falls_in=lambda motion, n: isinstance(motion, Push) and n == 3)

    result = run_episode(world, scenario_at_station(), 0, Always())

    assert (result.ending, result.success, result.n_cycles) == ("fell", False, 3)


def test_an_episode_ends_after_the_cycles_of_the_scenario() -> None:
    scenario = override(scenario_at_station(), {"mission.max_push_cycles": 4})

    result = run_episode(FakeWorld(), scenario, 0, Always())

    assert (result.ending, result.n_cycles) == ("max_cycles", 4)


def test_rows_come_in_the_order_of_cases_and_seeds_however_many_worlds_there_are() -> None:
    cases = make_sweep(scenario_at_station(), ["box.mass_kg=0.1,0.5"], grid=False).cases
    seen: list[Row] = []
    one, three = (
        evaluate([FakeWorld() for _ in range(n)], cases, range(3), ScriptedPolicy(), seen.append) for n in (1, 3)
    )

    assert one == three
    assert [(r.case, r.seed) for r in one] == [(c, s) for c in ("box.mass_kg=0.1", "box.mass_kg=0.5") for s in range(3)]
    assert seen == one + three


def test_a_share_has_wilsons_interval() -> None:
    some, all_of_them = wilson(8, 10), wilson(50, 50)

    assert (some.value, round(some.low, 3), round(some.high, 3)) == (0.8, 0.49, 0.943)
    assert (round(all_of_them.low, 3), round(all_of_them.high, 6)) == (0.929, 1.0)


def test_the_interval_of_a_mean_holds_it_and_is_always_the_same() -> None:
    values = [0.0, 1.0, 2.0, 3.0]

    estimate = mean_interval(values)

    assert estimate.value == 1.5
    assert 0.0 <= estimate.low < 1.5 < estimate.high <= 3.0
    assert mean_interval(values) == estimate


def test_the_summary_counts_falls_and_keeps_extremes() -> None:
    rows = [row(position_error_m=0.01), row(seed=1, position_error_m=0.03, ending="fell"), row(case="b", seed=0)]

    summaries = summarize(rows)

    assert list(summaries) == ["", "b"]
    assert (summaries[""].n, summaries[""].n_falls, summaries[""].success_rate.value) == (2, 1, 0.5)
    assert summaries[""].largest_position_error_m == 0.03
    assert summaries[""].position_error_m.value == pytest.approx(0.02)


def test_rows_have_the_swept_fields_as_columns_in_csv_and_parquet(tmp_path: Path) -> None:
    sweep = make_sweep(scenario_at_station(), ["box.mass_kg=0.1,0.5", "box.size_m=0.4x0.5x0.4"], grid=True)
    rows = table([row(case=case, seed=seed) for case in sweep.cases for seed in (0, 1)], sweep)
    write_parquet(rows, tmp_path / "episodes.parquet")

    lines = list(csv.DictReader(io.StringIO(as_csv(rows))))
    assert [(line["box.mass_kg"], line["box.size_m"], line["seed"]) for line in lines] == [
        (mass, "0.4x0.5x0.4", seed) for mass in ("0.1", "0.5") for seed in ("0", "1")
    ]
    assert lines[0]["position_error_m"] == "0.01"
    read = parquet.read_table(tmp_path / "episodes.parquet").to_pylist()
    assert read == [dict(line) for line in rows]


@pytest.mark.parametrize(
    ("sweeps", "grid"),
    [([], False), (["box.mass_kg=0.1,0.5"], False), (["box.mass_kg=0.1,2", "box.friction=0.3,0.8"], True)],
)
def test_the_plot_is_a_png(tmp_path: Path, sweeps: list[str], grid: bool) -> None:
    sweep = make_sweep(scenario_at_station(), sweeps, grid=grid)

    save_plot([row(case=case) for case in sweep.cases], sweep, "a policy", tmp_path / "plot.png")

    assert (tmp_path / "plot.png").read_bytes().startswith(b"\x89PNG")
