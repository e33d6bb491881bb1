"""A path of the box in a random room is exact, and its clearance is measured by other means."""

from benchmarks.box_path import BOX_PATH, BoxPath
from legpush.study.cells import columns_of


def test_a_path_in_an_empty_room_keeps_clear() -> None:
    found = columns_of(BOX_PATH, BoxPath(seed=80_000, obstacles=0))

    assert found["status"] == "exact"
    assert found["spare_m"] > 0.0
    assert found["planning_s"] > 0.0
    assert list(found) == [column.name for column in BOX_PATH.columns]
