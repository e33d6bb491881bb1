"""Clearance of moving rectangles, compared with the distance to every occupied square one by one."""

import numpy as np
import pytest
from msgspec.structs import replace

from legpush.arrays import Floats
from legpush.geometry import Pose2
from legpush.scene.footprints import Footprint, distance_m
from legpush.scene.occupancy import OccupancyGrid
from planner_proc.clearance.field import ClearanceField
from planner_proc.clearance.footprint_field import FootprintField, Squares, placed
from tests.planner import maps
from tests.planner.maps import pose

FOOTPRINTS = (
    Footprint(pose=pose(0.15, 0.0), length_m=0.4, width_m=0.5),
    Footprint(pose=pose(-0.5, 0.1, 0.3), length_m=0.7, width_m=0.4),
)
RESOLUTION_M = 0.1


def true_distance_m(grid: OccupancyGrid, frame: Pose2) -> float:
    """Least distance of the footprints to occupied squares and to the border; negative where they overlap."""
    cells = np.frombuffer(grid.cells, dtype=np.uint8).reshape(grid.n_rows, grid.n_columns)
    squares = [
        Footprint(
            pose=pose((column + 0.5) * RESOLUTION_M, (row + 0.5) * RESOLUTION_M),
            length_m=RESOLUTION_M,
            width_m=RESOLUTION_M,
        )
        for row, column in np.argwhere(cells).tolist()
    ]
    moved = [replace(footprint, pose=frame @ footprint.pose) for footprint in FOOTPRINTS]
    size_m = np.array([grid.n_columns, grid.n_rows]) * RESOLUTION_M
    to_border_m = min(float(np.minimum(one.corners(), size_m - one.corners()).min()) for one in moved)
    return min([to_border_m, *(distance_m(one, square) for one in moved for square in squares)])


def some_poses(seed: int, n: int) -> Floats:
    return np.random.default_rng(seed).uniform([0.5, 0.5, -np.pi], [7.5, 5.5, np.pi], (n, 3))


@pytest.mark.parametrize("seed", range(3))
def test_the_exact_measure_is_the_distance_to_the_nearest_square(seed: int) -> None:
    grid = maps.random_room(np.random.default_rng(seed))
    field = FootprintField(FOOTPRINTS, ClearanceField(grid), Squares(grid))
    poses = some_poses(seed, 12)
    expected_m = np.array([true_distance_m(grid, pose(*each)) for each in poses.tolist()])

    measured_m = [field.clearance_m(each[None]) for each in poses]

    np.testing.assert_allclose(measured_m, np.maximum(expected_m, 0.0), atol=1e-9)
    assert field.free(poses, 0.1).tolist() == (expected_m >= 0.1).tolist()
    assert field.clearance_m(poses) == pytest.approx(max(expected_m.min(), 0.0))
    assert 0 < (expected_m >= 0.1).sum() < len(poses)


def test_the_quick_measure_errs_by_a_few_centimetres_on_a_fine_grid() -> None:
    coarse = maps.random_room(np.random.default_rng(5))
    cells = np.frombuffer(coarse.cells, dtype=np.uint8).reshape(coarse.n_rows, coarse.n_columns)
    grid = maps.grid(cells.repeat(5, axis=0).repeat(5, axis=1), RESOLUTION_M / 5)
    field = FootprintField(FOOTPRINTS, ClearanceField(grid), Squares(grid))
    clearance_m, verdicts = 0.2, []
    for each in some_poses(5, 300):
        seems_free = field.seems_free(each[None], clearance_m)
        if field.free(each[None], clearance_m + 0.04)[0]:
            assert seems_free
        if not field.free(each[None], clearance_m - 0.02)[0]:
            assert not seems_free
        verdicts.append(seems_free)
    assert 30 < sum(verdicts) < 270


def test_a_field_knows_its_farthest_point_and_the_narrowest_passage() -> None:
    grid = maps.room()
    field = FootprintField(FOOTPRINTS, ClearanceField(grid), Squares(grid))

    assert field.reach_m == pytest.approx(max(np.hypot(*one.corners().T).max() for one in FOOTPRINTS))
    assert field.narrowest_m == 0.2


def test_poses_compose_with_a_pose_in_their_frame() -> None:
    frames = some_poses(0, 5)
    what = pose(0.3, -0.2, 0.7)

    expected = [pose(*frame) @ what for frame in frames.tolist()]

    np.testing.assert_allclose(placed(frames, what)[:, :2], [each.xy() for each in expected])
    np.testing.assert_allclose(np.cos(placed(frames, what)[:, 2] - [each.yaw_rad for each in expected]), 1.0)
