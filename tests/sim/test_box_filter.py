"""The filter of what is seen of the box, against plain averages and the last look."""

from math import radians

import numpy as np
import pytest
from msgspec.structs import replace

from legpush.arrays import Floats
from legpush.geometry import Pose2, wrap_angle
from legpush.realism.reality import EXACT
from legpush.scenarios.file import load_scenario
from sim_proc.box_filter import LEAST_SHARE, NEAR_M, BoxFilter

BOX = load_scenario("push").box
SENSED = replace(EXACT, noise_m=0.01, noise_deg=1.0)
FAR = np.array([[[9.0, 9.0, 0.02]]])


def looks(n: int, at: Pose2, seed: int = 0) -> list[Pose2]:
    generator = np.random.default_rng(seed)
    noise = generator.standard_normal((n, 3)) * [SENSED.noise_m, SENSED.noise_m, radians(SENSED.noise_deg)]
    return [
        Pose2(x_m=at.x_m + dx, y_m=at.y_m + dy, yaw_rad=wrap_angle(at.yaw_rad + turn))
        for dx, dy, turn in noise.tolist()
    ]


def off_m(seen: Pose2, at: Pose2) -> float:
    return float(np.hypot(seen.x_m - at.x_m, seen.y_m - at.y_m))


def filtered(seen: list[Pose2]) -> BoxFilter:
    box = BoxFilter(BOX, SENSED, seen[0])
    for look in seen[1:]:
        box.pass_ticks(FAR)
        box.look(look, box.n_moving)
    return box


@pytest.mark.parametrize("n", [1, 2, 5, 30])
@pytest.mark.parametrize("yaw_deg", [0.0, 179.9])
def test_looks_at_a_box_that_stands_are_averaged(n: int, yaw_deg: float) -> None:
    at = Pose2(x_m=1.0, y_m=-2.0, yaw_rad=radians(yaw_deg))
    seen = looks(n, at)
    box = filtered(seen)
    np.testing.assert_allclose(box.pose.xy(), np.mean([look.xy() for look in seen], axis=0), atol=1e-12)
    turns = [wrap_angle(look.yaw_rad - at.yaw_rad) for look in seen]
    assert wrap_angle(box.pose.yaw_rad - at.yaw_rad) == pytest.approx(np.mean(turns), abs=1e-12)


def foot_at(x_m: float, y_m: float) -> Floats:
    """A foot in one tick, (1, 1, 3)."""
    return np.array([[[x_m, y_m, 0.02]]])


def test_many_looks_are_far_better_than_the_last_one() -> None:
    at = Pose2(x_m=0.0, y_m=0.0, yaw_rad=0.0)
    errors = [off_m(filtered(looks(40, at, seed)).pose, at) for seed in range(40)]
    last = [off_m(looks(40, at, seed)[-1], at) for seed in range(40)]
    assert np.mean(errors) < np.mean(last) / 4


def test_old_looks_fade() -> None:
    at = Pose2(x_m=0.0, y_m=0.0, yaw_rad=0.0)
    box = filtered([at] * 500)
    box.look(replace(at, x_m=0.01), box.n_moving)
    assert box.pose.x_m == pytest.approx(LEAST_SHARE * 0.01)


def test_a_box_that_a_foot_moves_is_where_it_was_seen_last() -> None:
    at = Pose2(x_m=0.0, y_m=0.0, yaw_rad=0.0)
    box = filtered(looks(40, at))
    for tick in range(1, 26):
        at = replace(at, x_m=0.004 * tick)
        box.pass_ticks(foot_at(at.x_m - BOX.size_m[0] / 2 - 0.02, 0.0))
        if tick % 5 == 0:
            box.look(at, box.n_moving)
            assert off_m(box.pose, at) < 0.002
    assert box.n_moving == 25


def test_a_look_from_before_a_push_is_averaged_with_those_before_it() -> None:
    at = Pose2(x_m=0.0, y_m=0.0, yaw_rad=0.0)
    box = filtered([at] * 39)
    for _ in range(5):
        box.pass_ticks(foot_at(0.0, 0.0))
    box.look(replace(at, x_m=0.04), n_moving=0)
    assert box.pose.x_m == pytest.approx(0.04 / 40)
    box.look(replace(at, x_m=0.05), n_moving=5)
    assert box.pose.x_m == pytest.approx(0.05, rel=0.1)


def test_a_box_that_was_moved_unseen_is_found_at_once() -> None:
    at = Pose2(x_m=0.0, y_m=0.0, yaw_rad=0.0)
    box = filtered(looks(40, at))
    there = Pose2(x_m=0.5, y_m=0.0, yaw_rad=radians(60.0))
    box.look(there, box.n_moving)
    assert off_m(box.pose, there) < 0.01
    assert abs(box.pose.yaw_rad - there.yaw_rad) < radians(1.0)


def test_exact_looks_are_taken_as_they_are() -> None:
    at = Pose2(x_m=0.0, y_m=0.0, yaw_rad=0.0)
    box = BoxFilter(BOX, replace(EXACT, rate_hz=10.0), at)
    box.look(replace(at, x_m=0.01), 0)
    assert box.pose.x_m == 0.01


def test_a_foot_moves_the_box_within_reach_of_its_sides_only() -> None:
    half_m = BOX.size_m[0] / 2
    at = Pose2(x_m=0.0, y_m=0.0, yaw_rad=radians(90.0))
    box = BoxFilter(BOX, SENSED, at)
    box.pass_ticks(foot_at(0.0, -half_m - NEAR_M - 0.01))
    assert box.n_moving == 0
    box.pass_ticks(foot_at(0.0, -half_m - NEAR_M + 0.01))
    assert box.n_moving == 1
