"""The picture of an evaluation."""

from pathlib import Path

import pytest

from agent_proc.evaluation.plot import save_plot
from agent_proc.evaluation.sweep import make_sweep
from tests.agent.evaluation.rows import row
from tests.agent.fake_world import scenario_at_station


@pytest.mark.parametrize(
    ("sweeps", "grid"),
    [([], False), (["box.mass_kg=0.1,0.5"], False), (["box.mass_kg=0.1,2", "box.friction=0.3,0.8"], True)],
)
def test_the_plot_is_a_png(tmp_path: Path, sweeps: list[str], grid: bool) -> None:
    sweep = make_sweep(scenario_at_station(), sweeps, grid=grid)

    save_plot([row(case=case) for case in sweep.cases], sweep, "a policy", tmp_path / "plot.png")

    assert (tmp_path / "plot.png").read_bytes().startswith(b"\x89PNG")


def test_the_plot_depends_on_the_episodes_alone(tmp_path: Path) -> None:
    sweep = make_sweep(scenario_at_station(), ["box.mass_kg=0.1,2", "box.friction=0.3,0.8"], grid=True)
    pictures = []
    for name, last_m in (("a", 0.01), ("b", 0.01), ("c", 0.05)):
        *rest, last = sweep.cases
        rows = [*(row(case=case) for case in rest), row(case=last, position_error_m=last_m)]
        save_plot(rows, sweep, "a policy", tmp_path / f"{name}.png")
        pictures.append((tmp_path / f"{name}.png").read_bytes())

    assert pictures[0] == pictures[1] != pictures[2]
