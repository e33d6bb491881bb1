"""`python -m benchmarks.view`: what a page costs, and how fast it is, in a Chromium that draws without a GPU.

How long the first picture takes; how many frames are drawn of a recording that plays and of missions that go on; whom
the page asks; and, in turn, missions with and without such a page open.
"""

import os
import re
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from time import monotonic, sleep
from urllib.parse import urlsplit

import tyro

from legpush.launch.summary import read_report
from tests.chromium import Browser, Page, browser, until

CLI = "import sys; from legpush.cli import main; sys.exit(main())"


@dataclass(frozen=True, kw_only=True)
class Config:
    """How much to measure."""

    query: str = "?fixedDpr=0.5"
    """Of the address: half the pixels each way; empty for all of them."""
    openings: int = 5
    """Of a page, until the robot is there."""
    seconds: float = 10.0
    """Of playing, for frames per second."""
    missions: int = 5
    """With and without a page, each."""
    scenario: str = "default"
    seed: int = 0
    """Of the missions."""


def main(config: Config) -> None:
    """Measure and print."""
    with tempfile.TemporaryDirectory(prefix="bench-view-") as name, browser() as chrome:
        folder = Path(name)
        os.environ["TMPDIR"] = name  # nobody else's runs
        recording = folder / "mission.mcap"
        run(folder / "recorded", config, "--record", str(recording))
        with viewer(str(recording)) as url:
            measure_openings(chrome, f"{url}/{config.query}", config.openings)
            measure_frames(chrome, f"{url}/{config.query}", config.seconds)
        with viewer() as url:
            measure_missions(chrome, f"{url}/{config.query}", folder, config)


def measure_openings(chrome: Browser, url: str, n: int) -> None:
    """Seconds until what can be seen is drawn, from before the window opens."""
    seconds = []
    for _ in range(n):
        began = monotonic()
        with chrome.page(url) as page:
            until_drawn(page)
            seconds.append(monotonic() - began)
            hosts = {urlsplit(each).netloc for each in page.requests if not each.startswith(("data:", "blob:"))}
        if hosts != {urlsplit(url).netloc}:
            raise RuntimeError(f"The page asked {hosts}")
    print(f"first picture: {statistics.median(seconds):.2f} s ({min(seconds):.2f} to {max(seconds):.2f}, n {n})")
    print(f"hosts that the page asked: {', '.join(hosts)}")


def measure_frames(chrome: Browser, url: str, seconds: float) -> None:
    """Frames per second of a recording that plays."""
    with chrome.page(url) as page:
        until_drawn(page)
        sleep(3.0)
        print(f"recording that plays: {frames_per_second(page, seconds):.1f} frames/s")


def measure_missions(chrome: Browser, url: str, folder: Path, config: Config) -> None:
    """Wall time of missions, by turns with a page that follows and without one; frames while they go on."""
    pairs, rates, crcs = [], [], set()
    for index in range(config.missions):
        alone = run(folder / f"{index}-alone", config)
        with chrome.page(url) as page:
            until_drawn(page)
            sleep(2.0)
            page.click_if("Follow live")
            before = (page.js("window.__nFrames"), monotonic())
            seen = run(folder / f"{index}-seen", config)
            rates.append((page.js("window.__nFrames") - before[0]) / (monotonic() - before[1]))
        pairs.append((alone["wall_time_s"], seen["wall_time_s"]))
        crcs |= {alone["state_crc"], seen["state_crc"]}
    ratios = [seen / alone for alone, seen in pairs]
    print(f"live: {statistics.median(rates):.1f} frames/s ({min(rates):.1f} to {max(rates):.1f}, n {len(rates)})")
    print(
        f"mission {config.scenario}, n {config.missions}: {statistics.median(a for a, _ in pairs):.2f} s without, "
        f"{statistics.median(b for _, b in pairs):.2f} s with a page; ratio {statistics.median(ratios):.3f} "
        f"({min(ratios):.3f} to {max(ratios):.3f}); {len(crcs)} end state(s)"
    )


def frames_per_second(page: Page, seconds: float) -> float:
    """What WebGL draws."""
    first, began = page.js("window.__nFrames"), monotonic()
    sleep(seconds)
    return float((page.js("window.__nFrames") - first) / (monotonic() - began))


def until_drawn(page: Page) -> None:
    """Wait until WebGL has drawn the robot, or what there is before a run."""
    page.until("window.__nFrames > 2 && /box error|Nothing has moved/.test(document.body.innerText)")


def run(out: Path, config: Config, *flags: str) -> dict[str, float]:
    """The report of a mission."""
    command = [sys.executable, "-c", CLI, "run", "--scenario", config.scenario, "--seed", str(config.seed)]
    subprocess.run([*command, "--out", str(out), "--no-video", *flags], check=True, capture_output=True)
    report: dict[str, float] = read_report(out)
    return report


@contextmanager
def viewer(*arguments: str) -> Iterator[str]:
    """The address of a page that is served."""
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
