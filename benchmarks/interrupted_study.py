"""`python -m benchmarks.interrupted_study`: a study of stub cells whose head and workers are killed at random.

After each kill every file must be whole; in the end every cell must have one row, with the right numbers. The
result goes to `results/interrupted_study.json`.
"""

import os
import random
import signal
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Final

import psutil
import tyro

from benchmarks.report import write_report
from legpush.study.folder import StudyFolder

CELL: Final = "tests.legpush.study.stub:STUB"


@dataclass(frozen=True, kw_only=True)
class Config:
    """The study and its interruptions."""

    cells: int = 10_000
    seconds: float = 0.01
    """How long each cell takes."""
    kills: int = 10
    seed: int = 0
    """Seed of what is killed, and when."""
    workers: int = 2


def main(config: Config) -> None:
    """Run the study with its kills, and report what was seen."""
    write_report("interrupted_study", interrupted(config))


def interrupted(config: Config) -> dict[str, Any]:
    """Run the study with its kills, check it, and return what was seen."""
    draw = random.Random(config.seed)
    with TemporaryDirectory(prefix="legpush-interrupted-") as scratch:
        file, out = Path(scratch) / "study.toml", Path(scratch) / "out"
        file.write_text(
            f'name = "interrupted"\n[settings]\nfactor = 3.0\nseconds = {config.seconds}\n'
            f"[axes]\nseed = {{ first = 0, n = {config.cells} }}\n"
        )
        command = [
            str(Path(sys.executable).with_name("legpush")),
            "study",
            "run",
            str(file),
            "--out",
            str(out),
            "--cell",
            CELL,
        ]
        command += ["--workers", str(config.workers)]
        began_s = time.perf_counter()
        head = _start(command)
        folder, killed = StudyFolder(out), list[str]()
        spacing_s = config.cells * config.seconds / config.workers / (config.kills + 1)
        while len(killed) < config.kills:
            n_before = _n_rows(folder)
            _wait_for_more(folder, head, n_before)
            time.sleep(draw.uniform(0.0, spacing_s))
            if head.poll() is not None:
                break
            workers = [
                child for child in psutil.Process(head.pid).children() if "spawn_main" in " ".join(child.cmdline())
            ]
            if draw.random() < 0.5 and workers:
                draw.choice(workers).send_signal(signal.SIGKILL)
                killed.append("worker")
                continue
            head.kill()
            head.wait()
            killed.append("head")
            _wait_for_end(workers)
            folder.rows()
            head = _start(command)
        code = head.wait()
        took_s = time.perf_counter() - began_s
        table = folder.rows()
        rows = [] if table is None else table.to_pylist()
        leftover = [path.name for path in out.rglob("*") if path.suffix == ".part"]
        return {
            "cells": config.cells,
            "n_kills": len(killed),
            "killed": killed,
            "exit_code": code,
            "rows": len(rows),
            "different_cells": len({row["cell"] for row in rows}),
            "wrong": sum(row["value"] != 3.0 * row["seed"] for row in rows),
            "seeds_in_order": [row["seed"] for row in rows] == list(range(config.cells)),
            "failed": len(folder.failures()),
            "torn_files": leftover,
            "took_s": round(took_s, 1),
            "without_kills_s": round(config.cells * config.seconds / config.workers, 1),
        }


def _start(command: list[str]) -> subprocess.Popen[bytes]:
    return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env=os.environ)


def _n_rows(folder: StudyFolder) -> int:
    return len(folder.done())


def _wait_for_more(folder: StudyFolder, head: subprocess.Popen[bytes], n_before: int) -> None:
    """Wait until the head has written rows, or has ended."""
    while head.poll() is None and _n_rows(folder) <= n_before:
        time.sleep(0.05)


def _wait_for_end(workers: list[psutil.Process]) -> None:
    """Wait until the workers of a killed head are gone, too."""
    _, alive = psutil.wait_procs(workers, timeout=10.0)
    if alive:
        raise SystemExit(f"workers outlived their head: {alive}")


if __name__ == "__main__":
    main(tyro.cli(Config))
