"""`python -m benchmarks.pictures.films --against OLD_CHECKOUT`: what the film of a mission costs, before and after.

The same mission is filmed by this checkout and by another one, in turn. CPU seconds are those of all processes of the
film. Frames per second are per wall second, and mean something only on a machine with nothing else to do.
"""

import os
import resource
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from time import perf_counter
from typing import Annotated, Any

import tyro

from benchmarks.report import write_report

HERE = Path(__file__).parents[2]
LEGPUSH = "import sys; from legpush.cli import main; sys.exit(main())"


@dataclass(frozen=True, kw_only=True)
class Config:
    """Film a mission several times."""

    against: Annotated[Path | None, tyro.conf.arg(metavar="DIR")] = None
    """Another checkout, which films the same mission."""
    label: str = "before"
    """Commit of the other checkout."""
    scenario: str = "default"
    """The mission."""
    n_runs: int = 3
    """Number of films by each checkout."""


def main(config: Config) -> None:
    """Run the mission once, film it in turn, and write the results."""
    checkouts = {"here": HERE} | ({"before": config.against.absolute()} if config.against is not None else {})
    with TemporaryDirectory() as scratch:
        folder = Path(scratch) / "run"
        run = [sys.executable, "-P", "-c", LEGPUSH, "run", config.scenario, "--no-video", "--no-picture"]
        subprocess.run([*run, "--quiet", "--out", str(folder)], env=environment_of(HERE), check=True)
        films: dict[str, list[dict[str, float]]] = {name: [] for name in checkouts}
        for _ in range(config.n_runs):
            for name, checkout in checkouts.items():
                films[name].append(film(folder, checkout))
                print(name, films[name][-1], flush=True)
    summaries = {name: summary(of) for name, of in films.items()}
    numbers: dict[str, Any] = {"scenario": config.scenario, "films": summaries}
    if config.against is not None:
        numbers["cpu_over_before"] = summaries["here"]["cpu_s"] / summaries["before"]["cpu_s"]
        numbers["before"] = config.label
    write_report("films", numbers)


def film(folder: Path, checkout: Path) -> dict[str, float]:
    """Film the run with the code of a checkout."""
    before, began_s = resource.getrusage(resource.RUSAGE_CHILDREN), perf_counter()
    command = [sys.executable, "-P", "-m", "sim_proc.render", str(folder)]
    subprocess.run(command, env=environment_of(checkout), check=True, stdout=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return {
        "cpu_s": after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime,
        "wall_s": perf_counter() - began_s,
        "n_frames": n_frames(folder / "mission.mp4"),
        "n_bytes": (folder / "mission.mp4").stat().st_size,
    }


def n_frames(file: Path) -> int:
    """Return the number of frames of a film."""
    import imageio_ffmpeg

    frames: int = imageio_ffmpeg.count_frames_and_secs(str(file))[0]
    return frames


def summary(films: list[dict[str, float]]) -> dict[str, Any]:
    """Return the medians of several films."""
    medians = {name: median(each[name] for each in films) for name in films[0]}
    n_frames = medians["n_frames"]
    rates = {"cpu_ms_per_frame": 1000 * medians["cpu_s"] / n_frames, "frames_per_wall_s": n_frames / medians["wall_s"]}
    return {"n": len(films), **medians, **rates}


def environment_of(checkout: Path) -> dict[str, str]:
    """Return an environment in which Python takes its modules from a checkout."""
    return {**os.environ, "PYTHONPATH": os.pathsep.join((str(checkout / "shared"), str(checkout)))}


if __name__ == "__main__":
    main(tyro.cli(Config))
