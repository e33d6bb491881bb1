"""An episode as one HTML file: it plays in a browser that is given nothing else, and asks no host for anything."""

import sys
from pathlib import Path

import numpy as np
import pytest

from sim_proc.export.html_file import FRAMES_PER_S, MOST_FRAMES, frame_rows, write_html
from sim_proc.export.source import Source, longest
from tests.chromium import browser, chromium

LARGEST_MB = 5.0
QUIET_MS = 1500


@pytest.fixture(scope="module")
def page(source: Source, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("html") / "episode.html"
    said: list[tuple[int, int]] = []
    timeline = longest(source.episodes).timeline
    what = write_html(source.history, timeline, path, lambda n, of: said.append((n, of)))
    n_rows = len(frame_rows(timeline))
    assert what.startswith(f"{n_rows} frames, ")
    assert said[-1] == (n_rows, n_rows)
    return path


def test_the_file_is_small_enough_to_share(page: Path) -> None:
    assert page.stat().st_size < LARGEST_MB * 1e6


def test_nothing_is_printed_by_the_server_that_it_is_made_with(
    source: Source, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    write_html(source.history, source.episodes[0].timeline, tmp_path / "a.html", lambda _n, _of: None)
    assert capfd.readouterr().out == ""
    assert "viser" not in sys.stdout.__class__.__module__


@pytest.mark.parametrize("n_rows", [2, 3, 500, 50_000])
def test_frames_are_even_with_the_first_and_the_last_row(n_rows: int) -> None:
    class Rows:
        """As many rows as a long or a short episode has."""

    timeline = Rows()
    timeline.n_rows = n_rows  # type: ignore[attr-defined]
    rows = frame_rows(timeline)  # type: ignore[arg-type]
    steps = np.diff(rows)

    assert (rows[0], rows[-1]) == (0, n_rows - 1)
    assert len(rows) <= MOST_FRAMES + 1
    assert (steps[:-1] == steps[0]).all()
    assert steps.max() >= min(n_rows - 1, round(50 / FRAMES_PER_S))


@pytest.mark.skipif(chromium() is None, reason="Chromium is not installed (Debian: chromium)")
def test_it_plays_from_a_disk_and_asks_no_host(page: Path) -> None:
    with browser((800, 600)) as opened, opened.page(page.as_uri()) as shown:
        shown.until("window.__nFrames > 3")
        shown.until(f"new Promise(done => setTimeout(() => done(true), {QUIET_MS}))")
        picture = shown.screenshot()

        assert shown.errors == []
        assert {request.split(":", 1)[0] for request in shown.requests} <= {"file", "data", "blob"}
        assert len(np.unique(picture.reshape(-1, 3), axis=0)) > 100
