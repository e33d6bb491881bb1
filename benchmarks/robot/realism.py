"""`python -m benchmarks.robot.realism`: the default mission in an ideal world and in a real one, seed by seed.

The rival of the filter of the box is its last look. A mission that ends in an error counts as one without success. The
numbers go to `results/realism.json`. It takes 10 min of CPU, and can be interrupted at any time: the same command goes
on, from results in `runs/benchmarks`.
"""

from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass
from functools import partial
from math import degrees, nan
from pathlib import Path
from statistics import median
from time import perf_counter
from typing import Any, Final, get_args

import msgspec
import tyro

from agent_proc.frames.poses import box_error
from agent_proc.mission.mission import run_mission
from agent_proc.policies.registry import make_policy
from agent_proc.statistics.intervals import mean, share
from agent_proc.studies.cell_parts import planner
from benchmarks.report import write_report
from benchmarks.robot.kept import Kept
from legpush.history.steps import PlanRecord, StepRecord
from legpush.lockstep.local import LocalWorld
from legpush.policy_names import DEFAULT_POLICY
from legpush.realism.settings import Profile
from legpush.scenarios.changes import override
from legpush.scenarios.file import load_scenario
from legpush.scene.conventions import CONTROL_PERIOD_S
from sim_proc import box_filter
from sim_proc.simulator import Simulator

LAST_LOOK: Final = "last_look"
"""The profile `real`, in which no more is known of the box than the last look at it says."""
VARIANTS: Final = (*get_args(Profile), LAST_LOOK)


@dataclass(frozen=True, kw_only=True)
class Config:
    """Which missions."""

    seeds: int = 20
    first_seed: int = 3100
    scenario: str = "default"


@contextmanager
def last_look_only() -> Iterator[None]:
    """Give the last look at a box its whole weight."""
    least = box_filter.LEAST_SHARE
    vars(box_filter)["LEAST_SHARE"] = 1.0
    try:
        yield
    finally:
        vars(box_filter)["LEAST_SHARE"] = least


def mission(scenario_name: str, profile: Profile, seed: int) -> dict[str, Any]:
    """Run one mission, and tell how it ended."""
    scenario = override(load_scenario(scenario_name), {"realism.profile": profile})
    records: list[StepRecord | PlanRecord] = []
    world = LocalWorld(Simulator(), planner(), on_record=records.append)
    began_s = perf_counter()
    result = run_mission(world, scenario, seed, make_policy(DEFAULT_POLICY))
    wall_s = perf_counter() - began_s
    last = next(record for record in reversed(records) if not isinstance(record, PlanRecord))[1]
    error = box_error(last.world, scenario)
    return {
        "seed": seed,
        "success": result.success,
        "reason": result.reason,
        "detail": result.detail,
        "position_error_m": error.position_m,
        "angle_error_deg": degrees(error.angle_rad),
        "n_push_cycles": result.n_push_cycles,
        "fell": last.world.fallen,
        "sim_time_s": last.world.tick * CONTROL_PERIOD_S,
        "wall_time_s": wall_s,
        "state_crc": f"{last.state_crc:08x}",
    }


def summary(rows: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """What came of the missions of one profile. Errors are those of the successes."""
    good = [row for row in rows if row["success"]]
    reasons = Counter(row["reason"] for row in rows if not row["success"])
    return {
        "n": len(rows),
        "n_successes": len(good),
        "success_rate": msgspec.to_builtins(share(len(good), len(rows))),
        "reasons": ", ".join(f"{reason} {n}" for reason, n in reasons.most_common()) or "none",
        "median_push_cycles": median(row["n_push_cycles"] for row in good) if good else nan,
        "most_push_cycles": max((row["n_push_cycles"] for row in good), default=0),
        "n_falls": sum(row["fell"] for row in rows),
        "times_real_time": median(row["sim_time_s"] / row["wall_time_s"] for row in rows),
        **{
            name: msgspec.to_builtins(mean([float(row[name]) for row in good]))
            for name in ("position_error_m", "angle_error_deg")
        },
    }


def main(config: Config) -> None:
    """Run all missions, and report them."""
    kept = Kept("realism", Path(__file__).parent)
    rows: dict[str, list[dict[str, Any]]] = {variant: [] for variant in VARIANTS}
    for seed in range(config.first_seed, config.first_seed + config.seeds):
        for variant, found in rows.items():
            run = partial(mission, config.scenario, "ideal" if variant == "ideal" else "real", seed)
            with last_look_only() if variant == LAST_LOOK else nullcontext():
                found.append(kept.result(f"{config.scenario}, {variant}, {seed}", dict[str, Any], run))
            print(variant, found[-1], flush=True)
    write_report(
        "realism",
        {
            "scenario": config.scenario,
            "policy": DEFAULT_POLICY,
            "first_seed": config.first_seed,
            "profiles": {variant: summary(found) for variant, found in rows.items()},
            "missions": rows,
        },
    )


if __name__ == "__main__":
    main(tyro.cli(Config))
