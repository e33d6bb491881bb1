from pathlib import Path

import numpy as np
import pytest
from msgspec.structs import replace

from agent_proc.figures import Figure
from agent_proc.policies.card import CurvePoint
from agent_proc.studies.comparison import curves as drawn
from agent_proc.studies.comparison.curves import MEASURES, N_POINTS, POSSIBLE, TITLES, WINDOW, make_curve, save_curves
from legpush.errors import ConfigError


def episodes(n: int, *, every: int, error_m: float) -> list[CurvePoint]:
    return [
        CurvePoint(
            step=every * (place + 1),
            episode_return=float(place),
            length=every,
            success=place % 2 == 0,
            position_error_m=error_m,
            angle_error_deg=1.0,
        )
        for place in range(n)
    ]


def test_a_curve_is_a_moving_mean_over_the_steps_that_all_trainings_have(tmp_path: Path) -> None:
    curve = make_curve("a", [episodes(100, every=10, error_m=0.01), episodes(60, every=15, error_m=0.03)])
    assert curve.steps[[0, -1]].tolist() == [15.0 * WINDOW, 900.0]
    assert curve.seeds["position_error_m"].shape == (2, N_POINTS)
    assert curve.seeds["position_error_m"][:, -1] == pytest.approx([0.01, 0.03])
    assert curve.seeds["success"] == pytest.approx(0.5)
    # At step 900 the first training ended its 90th episode, the second its 60th.
    expected = [np.mean(range(60, 90)), np.mean(range(30, 60))]
    assert curve.seeds["episode_return"][:, -1] == pytest.approx(expected)
    save_curves([curve, make_curve("b", [episodes(40, every=10, error_m=0.02)])], tmp_path / "c.png")
    assert (tmp_path / "c.png").read_bytes().startswith(b"\x89PNG")


def test_a_training_with_few_episodes_has_no_curve() -> None:
    with pytest.raises(ConfigError, match="a: expected trainings of 30 episodes or more for their curves, got 29"):
        make_curve("a", [episodes(29, every=10, error_m=0.01)])


def test_intervals_end_where_a_measure_does(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    figures: list[Figure] = []

    def keep(figure: Figure, path: Path, dpi: int) -> None:
        figures.append(figure)

    monkeypatch.setattr(drawn, "save_figure", keep)
    good, bad = (episodes(60, every=10, error_m=error_m) for error_m in (0.001, 0.2))
    curve = make_curve("a", [[replace(each, success=True) for each in good], bad])
    save_curves([curve], tmp_path / "c.png")

    assert curve.end("position_error_m").value == pytest.approx(0.1005)
    assert curve.end("position_error_m").low == 0.0
    assert curve.end("success").high == 1.0
    for axis, name in zip(figures[0].axes, MEASURES, strict=True):
        (_, scale), (least, most) = TITLES[name], POSSIBLE[name]
        heights = np.concatenate([path.vertices for path in axis.collections[0].get_paths()])[:, 1]
        assert scale * least <= heights.min() <= heights.max() <= scale * most
