"""A smaller run of the benchmark: `python -m benchmarks.interrupted_study` kills ten times among ten thousand cells."""

from benchmarks.interrupted_study import Config, interrupted


def test_every_cell_has_one_row_after_heads_and_workers_were_killed() -> None:
    seen = interrupted(Config(cells=300, seconds=0.06, kills=3, seed=4))
    assert set(seen["killed"]) == {"head", "worker"}
    assert len(seen["killed"]) == 3
    assert (seen["exit_code"], seen["rows"], seen["different_cells"]) == (0, 300, 300)
    assert (seen["wrong"], seen["failed"], seen["torn_files"]) == (0, 0, [])
    assert seen["seeds_in_order"]
