"""The cells of the experiments give the rows that are kept, and their fits find what is known."""

from math import pi
from typing import Any

import numpy as np
import pytest

from experiments.cells.circle import closing_m, fit_circle, fit_sine
from experiments.cells.close_up import CLOSE_UP
from experiments.cells.heavy_push import HEAVY_PUSH, STILL_CYCLES
from experiments.cells.informed import INFORMED
from experiments.cells.own_estimate import OWN_ESTIMATE
from experiments.cells.push_curve import PUSH_CURVE
from experiments.cells.recurrent import RECURRENT
from experiments.cells.straight_push import STRAIGHT_PUSH
from experiments.cells.turns import CURVES, TURNS
from experiments.cells.walk import WALK, path_of
from legpush.study.cells import CellKind, columns_of

ANGLES = np.linspace(0.0, 4 * pi, 200)


def result(kind: CellKind, **fields: Any) -> dict[str, Any]:
    return columns_of(kind, kind.resolve(kind.specification(**fields), ()))


def test_a_circle_is_found_in_its_points() -> None:
    points = np.array([1.0, 2.0]) + 0.5 * np.stack([np.cos(ANGLES), np.sin(ANGLES)], axis=1)

    centre_m, radius_m, rms_m = fit_circle(points)

    assert (*centre_m, radius_m) == pytest.approx((1.0, 2.0, 0.5))
    assert rms_m == pytest.approx(0.0, abs=1e-9)


def test_a_sine_is_found_in_its_values() -> None:
    time_s = np.linspace(0.0, 100.0, 500)

    found = fit_sine(time_s, 0.3 * np.sin(0.2 * time_s + 1.0) + 4.0, 0.19)

    assert (found["amplitude_m"], found["omega_rad_s"], found["phi_rad"], found["offset_m"]) == pytest.approx(
        (0.3, 0.2, 1.0, 4.0)
    )
    assert found["r2"] == pytest.approx(1.0)


def test_a_spiral_does_not_close() -> None:
    radius_m = 0.5 + 0.1 * ANGLES / (2 * pi)
    spiral = np.stack([ANGLES, radius_m * np.cos(ANGLES), radius_m * np.sin(ANGLES), ANGLES], axis=1)

    assert closing_m(spiral) == pytest.approx(0.1, abs=1e-3)


def test_the_s_curve_ends_aside_with_its_first_heading() -> None:
    path = path_of("s_curve")

    assert (path[-1].x_m, path[-1].y_m, path[-1].yaw_rad) == pytest.approx((12.0, 12.0, 0.0), abs=1e-9)


def test_a_turn_on_the_spot_ends_at_its_place_with_its_heading_reversed() -> None:
    found = result(WALK, path="turn_on_the_spot")

    assert found["end_yaw_error_deg"] < 0.5
    assert found["end_error_m"] < 0.03
    assert set(found) == {column.name for column in WALK.columns}


def test_four_pushes_bring_the_estimate_much_closer_to_what_was_measured() -> None:
    box = {"size_m": (0.6, 0.35, 0.4), "mass_kg": 0.1, "friction": 0.5, "shape": "cuboid"}
    measured_m = 2.239

    found = result(OWN_ESTIMATE, seed=50_100, face="rear", **box)

    assert abs(found["own_m"] - measured_m) < 0.6 * abs(found["guessed_m"] - measured_m)


def test_a_straight_push_has_the_box_and_the_trunk_at_the_same_times() -> None:
    found = result(STRAIGHT_PUSH, seed=20_000, policy="scripted")

    by_time = ("box_x_m", "box_y_m", "box_yaw_deg", "roll_deg", "pitch_deg")
    assert {len(found[name]) for name in by_time} == {len(found["roll_deg"])}
    assert found["box_x_m"][-1] - found["box_x_m"][0] == pytest.approx(1.0, abs=0.1)
    assert found["error_m"][0] > 0.8 > 0.03 > found["error_m"][-1]
    assert len(found["error_m"]) == len(found["error_deg"]) > 10


def test_a_cubic_push_of_the_swing_side_comes_from_above_and_moves_the_box() -> None:
    found = result(PUSH_CURVE, weights=(0.5, 0.5), locus="swing", leg="FL", depth_m=0.05, seed=1)

    assert set(found) == {column.name for column in PUSH_CURVE.columns}
    assert (found["degree"], found["refused"], found["fell"]) == (3, "", False)
    assert found["forward_m"] == pytest.approx(0.037, abs=0.003)
    assert found["contact_height_m"] == pytest.approx(0.2, abs=0.02)
    assert len(found["foot_x_m"]) == len(found["foot_z_m"]) > 40


def test_the_far_half_of_the_published_locus_leads_a_foot_along_the_floor() -> None:
    swing, published = (
        result(PUSH_CURVE, weights=(1.0, 1.0), locus=locus, leg="FL", depth_m=0.05, box_height_m=0.15, seed=1)
        for locus in ("swing", "published")
    )

    assert published["n_raised"] == 2
    assert published["lowest_asked_m"] < -0.02
    assert published["low_way_m"] > 0.05 > swing["low_way_m"]


def test_the_leg_of_a_close_up_has_the_lengths_of_its_links_and_ends_at_the_face() -> None:
    found = result(CLOSE_UP, mass_kg=0.1, w1=0.5, w2=0.5, leg="FL", depth_m=0.05, seed=1)

    place = {name: np.array([found[f"{name}_x_m"], found[f"{name}_z_m"]]) for name in ("hip", "knee", "foot", "box")}
    upper_m, lower_m = (
        np.linalg.norm(place[one] - place[other], axis=0) for one, other in (("hip", "knee"), ("knee", "foot"))
    )
    assert upper_m.max() == pytest.approx(0.3205, abs=0.002)
    assert lower_m.max() == pytest.approx(0.37, abs=0.002)
    assert place["foot"][0, -1] == pytest.approx(0.05 - 0.02, abs=0.005)
    assert place["box"][0, -1] > place["box"][0, 0] + 0.03
    assert len({len(found[f"{name}_x_m"]) for name in place} | {len(found["force_n"])}) == 1
    pressed = {name: np.array(found[f"press_{name}_m"]).reshape(-1, 3) for name in ("foot", "knee", "com")}
    here = found["press_tick"]
    assert pressed["knee"][0, [0, 2]] == pytest.approx(place["knee"][:, here], abs=1e-3)
    assert np.array(found["press_forces_n"]).reshape(-1, 3)[:, 2].sum() == pytest.approx(31.84 * 9.81, rel=0.05)
    assert pressed["com"].shape == (1, 3)


def test_a_box_that_no_push_moves_ends_its_episode_soon_and_is_beyond_the_bound() -> None:
    found = result(HEAVY_PUSH, seed=20_500, mass_kg=40.0, friction=1.0, force="none")

    assert (found["ending"], found["within"], found["n_cycles"]) == ("stuck", False, STILL_CYCLES)
    assert found["least_force_n"] > found["most_force_n"]
    assert set(found) == {column.name for column in HEAVY_PUSH.columns}


def test_the_known_friction_is_fed_forward_whatever_the_foot_feels() -> None:
    known, felt = (
        result(HEAVY_PUSH, seed=20_500, mass_kg=3.0, friction=0.5, force=force, policy="scripted")
        for force in ("known", "felt")
    )

    assert known["within"]
    assert felt["within"]
    assert known["state_crc"] != felt["state_crc"]


def test_a_box_is_turned_from_its_start_with_each_leg_and_curve() -> None:
    found = result(TURNS, task="push-l2", seed=6018, n_pushes=1)

    assert found["leg"] == ["FL"] * 5 + ["FR"] * 5
    assert list(zip(found["w1"], found["w2"], strict=True))[:5] == list(CURVES)
    assert max(found["turn_deg"][:5]) < -2.0
    assert min(found["turn_deg"][5:]) > 2.0


def test_an_oracle_has_pushed_the_box_before() -> None:
    found = result(INFORMED, task="push-l2", seed=6018, n_series=1)

    assert (found["policy"], found["n_known"], found["ending"], found["success"]) == ("informed", 8, "done", True)
    assert list(found) == [column.name for column in INFORMED.columns]


def test_a_recurrent_training_gives_the_same_ends_again() -> None:
    fields = {"task": "push-l1", "world": "map", "steps": 64, "n_simulators": 2, "n_steps": 16, "final_episodes": 2}
    first, again = result(RECURRENT, **fields), result(RECURRENT, **fields)

    there = result(RECURRENT, **fields, final_world="map_mean")

    assert first == again
    assert there["final_position_error_m"] != first["final_position_error_m"]
    assert len(first["final_success"]) == 2
    assert min(first["final_simulated_s"]) > 0.0
    assert set(first["final_ended"]) <= {"done", "fell", "astray", "refused", "max_cycles"}
