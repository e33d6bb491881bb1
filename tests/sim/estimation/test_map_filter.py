"""Where the world is, from noisy fixes."""

import numpy as np
import pytest

from legpush.geometry import Pose2, wrap_angle
from sim_proc.estimation.map_filter import MapFilter
from sim_proc.perception import Fix

DRIFT = Pose2(x_m=0.3, y_m=-0.2, yaw_rad=0.1)
"""Of the frame of the world in the one of the measurements."""


def way(n: int) -> list[Pose2]:
    """Poses in the world, 5 mm and some turn each tick."""
    poses = [Pose2(x_m=0.0, y_m=0.0, yaw_rad=0.0)]
    for k in range(n):
        poses.append(poses[-1] @ Pose2(x_m=0.005, y_m=0.0, yaw_rad=0.002 * np.sin(k / 50)))
    return poses


def located(seed: int, n: int = 1000, latency_ticks: int = 0, noise: float = 1.0, split: int = 40) -> MapFilter:
    """A filter after n ticks with a fix every 25 ticks."""
    random, world = np.random.default_rng(seed), way(n)
    odometry = [DRIFT @ pose for pose in world]
    fixes = []
    for tick in range(0, n + 1 - latency_ticks, 25):
        x, y, yaw = (noise * np.array([0.02, 0.02, np.radians(1.0)]) * random.standard_normal(3)).tolist()
        true = world[tick]
        seen = Pose2(x_m=true.x_m + x, y_m=true.y_m + y, yaw_rad=true.yaw_rad + yaw)
        fixes.append(Fix(tick=tick, given_tick=tick + latency_ticks if tick else 0, pose=seen))
    found = MapFilter(fixes[0], odometry[0])
    for first in range(1, n + 1, split):
        last = min(first + split, n + 1)
        rows = np.array([[pose.x_m, pose.y_m, pose.yaw_rad] for pose in odometry[first:last]])
        found.take(first, rows, [fix for fix in fixes[1:] if first <= fix.given_tick < last], latency_ticks)
    return found


def off(found: MapFilter, n: int) -> tuple[float, float]:
    """Errors of the robot's place and heading in the world."""
    world = way(n)[-1]
    seen = found.place.inverse() @ (DRIFT @ world)
    return float(np.hypot(seen.x_m - world.x_m, seen.y_m - world.y_m)), wrap_angle(seen.yaw_rad - world.yaw_rad)


@pytest.mark.parametrize("latency_ticks", [0, 7, 60])
def test_exact_fixes_find_the_drift_however_late_they_come(latency_ticks: int) -> None:
    place = located(0, latency_ticks=latency_ticks, noise=0.0).place
    assert (place.x_m, place.y_m, place.yaw_rad) == pytest.approx((DRIFT.x_m, DRIFT.y_m, DRIFT.yaw_rad), abs=1e-9)


def test_noisy_fixes_are_averaged() -> None:
    errors = np.array([off(located(seed), 1000) for seed in range(20)])
    assert np.sqrt((errors[:, 0] ** 2).mean()) < 0.014
    assert np.degrees(np.sqrt((errors[:, 1] ** 2).mean())) < 0.4


def test_the_world_moves_only_with_a_fix_and_runs_may_be_split() -> None:
    assert located(3, split=7).as_bytes() == located(3, split=500).as_bytes()
    found = located(1)
    place = found.place
    found.take(1001, np.array([[9.0, 9.0, 1.0]]), [], 0)
    assert found.place == place
