"""Results that are kept are not made again, and other code has results of its own."""

from pathlib import Path
from typing import Any

import pytest

from benchmarks.robot.kept import Kept

Row = dict[str, Any]


def done(way_m: float) -> Row:
    return {"fell": False, "stopped": True, "duration_s": 0.1 + 0.2, "way_m": way_m, "places": [[0.5, 0.25]]}


def never() -> Row:
    raise AssertionError("expected the kept result")


@pytest.fixture
def sources(tmp_path: Path) -> Path:
    """The code of a benchmark."""
    folder = tmp_path / "benchmark"
    folder.mkdir()
    (folder / "walk.py").write_text("n = 1\n")
    return folder


def test_a_benchmark_that_was_interrupted_goes_on_with_the_same_results(sources: Path, tmp_path: Path) -> None:
    first = Kept("walks", sources, tmp_path)
    assert first.result("walk 0", Row, lambda: done(1.0)) == done(1.0)
    with pytest.raises(KeyboardInterrupt):
        first.result("walk 1", Row, _interrupt)

    again = Kept("walks", sources, tmp_path)
    assert again.result("walk 0", Row, never) == done(1.0)
    assert again.result("walk 1", Row, lambda: done(2.0)) == done(2.0)


def test_other_code_does_not_use_kept_results(sources: Path, tmp_path: Path) -> None:
    Kept("walks", sources, tmp_path).result("walk 0", Row, lambda: done(1.0))
    (sources / "walk.py").write_text("n = 2\n")
    assert Kept("walks", sources, tmp_path).result("walk 0", Row, lambda: done(2.0)) == done(2.0)


def _interrupt() -> Row:
    raise KeyboardInterrupt
