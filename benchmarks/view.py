"""`python -m benchmarks.view`: measures the speed and the cost of a page, in a Chromium that draws without a GPU.

Measured are the time to the first picture, the frames per second of a recording and of live missions, the hosts that
the page contacts, and the wall times of missions with and without an open page, in turn. The numbers go to
`results/view.json`.
"""

import os
import re
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from time import monotonic, sleep
from typing import Any
from urllib.parse import urlsplit

import tyro

from agent_proc.statistics.paired import paired_ratio
from benchmarks.report import write_report
from experiments.tables.parts import plain
from legpush.runs.report import read_report
from tests.chromium import Browser, Page, browser, until

CLI = "import sys; from legpush.cli import main; sys.exit(main())"


@dataclass(frozen=True, kw_only=True)
class Config:
    """Length of the measurement."""

    query: str = "&fixedDpr=0.5"
    """What to add to the query of the address; by default half the pixels each way, empty for all pixels."""
    openings: int = 5
    """How often to open a page and wait for the robot."""
    seconds: float = 10.0
    """How long to play for a count of frames."""
    missions: int = 5
    """Number of missions with a page, and of missions without."""
    scenario: str = "default"
    seed: int = 0
    """Seed of the missions."""


def main(config: Config) -> None:
    """Measure everything and report the results."""
    with tempfile.TemporaryDirectory(prefix="bench-view-") as name:
        folder = Path(name)
        os.environ["TMPDIR"] = name  # so that no other runs are found
        recording = folder / "mission.mcap"
        run(folder / "recorded", config, "--record", str(recording))
        with browser() as chrome, viewer(str(recording)) as url:
            first_picture = measure_openings(chrome, f"{url}{config.query}", config.openings)
            frames_hz = measure_frames(chrome, f"{url}{config.query}", config.seconds)
        missions = [measure_missions(folder, config, niceness) for niceness in (0, 19)]
    write_report(
        "view", {"first_picture": first_picture, "recording_frames_hz": round(frames_hz, 1), "missions": missions}
    )


def measure_openings(chrome: Browser, url: str, n: int) -> dict[str, Any]:
    """Measure the time from before the window opens until the scene is drawn."""
    seconds = []
    for _ in range(n):
        began = monotonic()
        with chrome.page(url) as page:
            until_drawn(page)
            seconds.append(monotonic() - began)
            hosts = {urlsplit(each).netloc for each in page.requests if not each.startswith(("data:", "blob:"))}
        if hosts != {urlsplit(url).netloc}:
            raise RuntimeError(f"Expected requests to {url} only, the page contacted {hosts}")
    return {
        "n": n,
        "median_s": round(statistics.median(seconds), 3),
        "least_s": round(min(seconds), 3),
        "longest_s": round(max(seconds), 3),
    }


def measure_frames(chrome: Browser, url: str, seconds: float) -> float:
    """Measure the frames per second of a playing recording."""
    with chrome.page(url) as page:
        until_drawn(page)
        sleep(3.0)
        return frames_per_second(page, seconds)


def measure_missions(folder: Path, config: Config, niceness: int) -> dict[str, Any]:
    """Measure wall times of missions with a following page and without one, in turn, and frames while the robot
    moves."""
    pairs, rates, crcs = [], [], set()
    with browser(niceness=niceness) as chrome:
        for index in range(config.missions):
            alone = run(folder / f"{niceness}-{index}-alone", config)
            with viewer() as url, chrome.page(f"{url}{config.query}") as page:
                until_drawn(page)
                sleep(1.0)
                with ThreadPoolExecutor(1) as pool:
                    seen_by = pool.submit(run, folder / f"{niceness}-{index}-seen", config)
                    rates.append(frames_while_moving(page, seen_by))
                seen = seen_by.result()
            pairs.append((alone["wall_time_s"], seen["wall_time_s"]))
            crcs |= {alone["state_crc"], seen["state_crc"]}
    alone_s, seen_s = zip(*pairs, strict=True)
    ratio = paired_ratio(dict(enumerate(seen_s)), dict(enumerate(alone_s)))
    return {
        "scenario": config.scenario,
        "niceness_of_browser": niceness,
        "n": config.missions,
        "median_frames_hz": round(statistics.median(rates), 1),
        "least_frames_hz": round(min(rates), 1),
        "largest_frames_hz": round(max(rates), 1),
        "median_without_s": round(statistics.median(alone_s), 3),
        "median_with_s": round(statistics.median(seen_s), 3),
        "with_over_without": plain(ratio, 4),
        "n_end_states": len(crcs),
    }


def frames_while_moving(page: Page, run_of: "Future[dict[str, float]]") -> float:
    """Return the frames per second between the first and the last change of the displayed simulated time."""
    seen: list[tuple[float, int, str]] = []
    while not run_of.done():
        n, shown = page.js("[window.__nFrames, document.querySelector('.mantine-NumberInput-input')?.value ?? '0']")
        if float(shown) > 0.0 and (not seen or seen[-1][2] != shown):
            seen.append((monotonic(), n, shown))
        sleep(0.05)
    if len(seen) < 2:
        raise RuntimeError("Expected a page that shows the mission while it runs, but nothing changed")
    (began, first, _), (ended, last, _) = seen[0], seen[-1]
    return (last - first) / (ended - began)


def frames_per_second(page: Page, seconds: float) -> float:
    """Return the frames that WebGL draws per second."""
    first, began = page.js("window.__nFrames"), monotonic()
    sleep(seconds)
    return float((page.js("window.__nFrames") - first) / (monotonic() - began))


def until_drawn(page: Page) -> None:
    """Wait until WebGL has drawn the robot, or the empty scene before a run."""
    page.until("window.__nFrames > 2 && /box error|Nothing has moved/.test(document.body.innerText)")


def run(out: Path, config: Config, *flags: str) -> dict[str, float]:
    """Run a mission and return its report."""
    command = [sys.executable, "-c", CLI, "run", config.scenario, "--seed", str(config.seed)]
    subprocess.run([*command, "--out", str(out), "--no-video", *flags], check=True, capture_output=True)
    report: dict[str, float] = read_report(out)
    return report


@contextmanager
def viewer(*arguments: str) -> Iterator[str]:
    """Start `legpush view`; yields the address of its page."""
    command = [sys.executable, "-c", CLI, "view", "--port", "0", *arguments]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    try:
        line = process.stdout.readline() if process.stdout is not None else ""
        found = until(lambda: re.search(r"http://\S+", line), "the address of the page")
        yield found[0]
    finally:
        process.terminate()
        process.wait()


if __name__ == "__main__":
    main(tyro.cli(Config))
