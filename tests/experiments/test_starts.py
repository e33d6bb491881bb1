"""Starts of a map: where the box is in the frame of its goal, and how many of those within a tube succeed."""

from docs.study_list import ROOT
from experiments.tables.benchmark.starts import _within, place_of
from legpush.study.file import load_study


def test_the_places_of_the_map_are_a_grid() -> None:
    study = load_study(ROOT / "experiments" / "studies" / "start_map.toml")
    rows = [study.values(index) for index in range(study.n_cells)]

    assert study.n_cells == 3 * 9 * 13
    assert {place_of(row)[0] for row in rows} == {round(0.05 * k, 3) for k in range(-4, 5)}
    assert {place_of(row)[1] for row in rows} == {5.0 * k for k in range(-6, 7)}


def test_a_box_to_the_left_of_the_line_has_a_positive_offset() -> None:
    """The goal is 1 m ahead of the box, which stands at (6, 6), 10 cm to its right and turned by 20°."""
    ahead = {"goal.pose.x_m": 7.0, "goal.pose.y_m": 5.9, "goal.pose.yaw_deg": 0.0}
    assert place_of(ahead) == (0.1, 0.0)
    assert place_of({**ahead, "goal.pose.yaw_deg": 20.0})[1] == -20.0


def test_starts_within_a_tube_are_counted() -> None:
    rows = [
        {"offset_m": 0.1, "heading_deg": -25.0, "success": True, "position_error_m": 0.01},
        {"offset_m": -0.1, "heading_deg": 5.0, "success": False, "position_error_m": 0.2},
        {"offset_m": 0.15, "heading_deg": 0.0, "success": False, "position_error_m": 3.0},
    ]
    assert _within(rows, 0.1, 25.0) == {"n": 2, "successes": 1, "largest_position_error_m": 0.2}
