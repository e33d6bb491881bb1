"""`python -m benchmarks.mission_cell`: missions in random rooms as cells of a study against `legpush run` for each.

Both draw the same rooms and end with the same `state_crc`, without picture and film. CPU seconds are those of all
processes, from the start of the programs to their end; those of the study that belong to no cell are shared out evenly.
The numbers go to `results/mission_cell.json`.
"""

import json
import resource
import subprocess
import sys
from dataclasses import asdict, dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time
from typing import Any, Final

import tyro

from agent_proc.reporting.mission_record import read_record
from agent_proc.statistics.intervals import median
from agent_proc.statistics.paired import paired_ratio
from agent_proc.studies.mission_cell import ResolvedMission, drawn
from agent_proc.studies.mission_numbers import numbers, tracks
from benchmarks.report import write_report
from experiments.tables.parts import plain
from legpush.history.steps import read_episode
from legpush.scenarios.file import write_scenario
from legpush.scenarios.random_room import RandomRoom
from legpush.study.folder import StudyFolder

LEGPUSH: Final = str(Path(sys.executable).with_name("legpush"))


@dataclass(frozen=True, kw_only=True)
class Config:
    """How much to measure."""

    first_seed: int = 63_000
    n: int = 8
    """Rooms, each with a seed of its own."""


@dataclass(frozen=True, kw_only=True)
class Pair:
    """A mission in both ways."""

    seed: int
    cell_cpu_s: float
    processes_cpu_s: float
    state_crc: str

    @property
    def ratio(self) -> float:
        """CPU seconds of the cell over those of the processes."""
        return self.cell_cpu_s / self.processes_cpu_s


def main(config: Config) -> None:
    """Measure and report the numbers."""
    cells = as_study(config)
    pairs = []
    for seed, (cell_cpu_s, crc) in cells.items():
        cpu_s, crc_of_run = as_processes(seed)
        if crc != crc_of_run:
            raise RuntimeError(f"Seed {seed}: {crc} as a cell, {crc_of_run} in three processes")
        pairs.append(Pair(seed=seed, cell_cpu_s=cell_cpu_s, processes_cpu_s=cpu_s, state_crc=crc))
        print(f"seed {seed}: CPU {cell_cpu_s:.1f} s as a cell, {cpu_s:.1f} s in three processes, {crc}", flush=True)
    cell_s, processes_s = {}, {}
    for pair in pairs:
        cell_s[pair.seed], processes_s[pair.seed] = pair.cell_cpu_s, pair.processes_cpu_s
    write_report(
        "mission_cell",
        {
            "n": len(pairs),
            "over_processes": {
                "median": plain(median([pair.ratio for pair in pairs]), 4),
                "geometric_mean": plain(paired_ratio(cell_s, processes_s), 4),
            },
            "pairs": [asdict(pair) for pair in pairs],
        },
    )


def as_study(config: Config) -> dict[int, tuple[float, str]]:
    """Run all missions as a study on one worker; return CPU seconds and CRC of each seed."""
    with TemporaryDirectory(prefix="legpush-mission-cell-") as scratch:
        file, out = Path(scratch) / "study.toml", Path(scratch) / "out"
        file.write_text(
            'name = "rooms"\ncell = "mission"\n[settings.random_room]\nobstacles = 10\n'
            f"[axes]\nseed = {{ first = {config.first_seed}, n = {config.n} }}\n"
        )
        before_s = _cpu_of_children_s()
        command = [LEGPUSH, "study", "run", str(file), "--out", str(out), "--workers", "1"]
        subprocess.run(command, check=True, capture_output=True)
        total_s = _cpu_of_children_s() - before_s
        table = StudyFolder(out).rows()
        rows: list[dict[str, Any]] = [] if table is None else table.to_pylist()
    rest_s = (total_s - sum(row["cpu_s"] for row in rows)) / len(rows)
    return {row["seed"]: (row["cpu_s"] + rest_s, row["state_crc"]) for row in rows}


def as_processes(seed: int) -> tuple[float, str]:
    """Draw the room here, run the mission in three processes, and measure it from its journal."""
    before_s = _cpu_of_children_s() + process_time()
    scenario, _ = drawn(
        ResolvedMission(
            seed=seed,
            scenario=None,
            random_room=RandomRoom(obstacles=10),
            changes={},
            policy="variable",
            policy_sha256="",
            push_map=None,
            push_map_sha256=None,
        )
    )
    with TemporaryDirectory(prefix="legpush-mission-cell-") as scratch:
        file, out = Path(scratch) / "scenario.toml", Path(scratch) / "run"
        write_scenario(scenario, file)
        command = [LEGPUSH, "run", str(file), "--seed", str(seed), "--out", str(out)]
        done = subprocess.run([*command, "--no-video", "--no-picture"], capture_output=True, check=False)
        if done.returncode not in (0, 1):
            raise RuntimeError(done.stderr.decode())
        report = json.loads((out / "report.json").read_bytes())
        record = read_record(read_episode(next(out.glob("episode-*.journal"))))
        numbers(record)
        tracks(record)
    return _cpu_of_children_s() + process_time() - before_s, report["state_crc"]


def _cpu_of_children_s() -> float:
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


if __name__ == "__main__":
    main(tyro.cli(Config))
