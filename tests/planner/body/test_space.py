"""Free poses of the body, compared with polygons."""

import numpy as np
import pytest

from legpush.arrays import Floats
from planner_proc.body.space import BodySpace
from planner_proc.clearance.field import ClearanceField
from tests.planner.bodies import BODY, BODY_M, least_distance_m
from tests.planner.maps import random_room

DISC_M = 0.3


def some_poses(seed: int, n: int) -> Floats:
    return np.random.default_rng(seed).uniform([0.5, 0.5, -np.pi], [7.5, 5.5, np.pi], (n, 3))


@pytest.mark.parametrize("seed", range(3))
def test_poses_are_free_where_the_polygon_of_the_body_keeps_its_clearance(seed: int) -> None:
    grid = random_room(np.random.default_rng(seed))
    space = BodySpace(grid, ClearanceField(grid), DISC_M, BODY, BODY_M)
    poses = some_poses(seed, 60)
    true_m = np.array([least_distance_m(grid, BODY, np.stack([pose, pose])) for pose in poses])

    assert space.body_is_free(poses).tolist() == (true_m >= BODY_M).tolist()
    for pose, apart_m in zip(poses, true_m.tolist(), strict=True):
        seems_free = bool(space.body_seems_free(pose[None, :2], pose[2], 0.0)[0])
        assert seems_free or apart_m < BODY_M + grid.resolution_m
        assert not seems_free or apart_m > BODY_M - grid.resolution_m
    assert 0 < (true_m >= BODY_M).sum() < len(poses)


def test_a_motion_has_its_faults_where_the_body_touches_something_in_between() -> None:
    grid = random_room(np.random.default_rng(4))
    space = BodySpace(grid, ClearanceField(grid), DISC_M, BODY, BODY_M)
    random = np.random.default_rng(4)
    n_faulty = 0
    for _ in range(20):
        begin = some_poses(int(random.integers(1000)), 1)[0]
        poses = np.stack([begin, begin + random.uniform(-0.4, 0.4, 3), begin + random.uniform(-0.4, 0.4, 3)])
        expected = [least_distance_m(grid, BODY, poses[k : k + 2]) for k in range(2)]
        faulty = space.faults(poses)
        for found, apart_m in zip(faulty.tolist(), expected, strict=True):
            assert found or apart_m > BODY_M - 0.01
        assert space.is_free(poses) == (not faulty.any())
        n_faulty += int(faulty.sum())
    assert 0 < n_faulty < 40
