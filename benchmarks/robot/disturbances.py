"""`python -m benchmarks.robot.disturbances`: walks and pushes in worlds that are not as they are taken to be.

Control is not told of it. The numbers go to `results/disturbances.json`. It takes 8 min of CPU, and can be interrupted
at any time: the same command goes on after the last disturbance, from results in `runs/benchmarks`.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, Final

import tyro

from benchmarks.report import write_report
from benchmarks.robot.kept import Kept
from benchmarks.robot.motions import Done, curved_walk, pushes, summary
from legpush.realism.settings import FloorTiles, Gusts, Realism

MASS_KG: Final = 1.0
"""Of the box that is pushed."""
AROUND: Final = (0.0, 360.0)
"""Any direction."""


@dataclass(frozen=True, kw_only=True)
class Config:
    """How often to walk and push."""

    seeds: int = 20
    """Number of walks, and of boxes that are pushed four times, with each disturbance."""
    first_seed: int = 1100


def gusts(force_n: float) -> Realism:
    """Gusts of 0.2 s from any direction, in any phase of the gait, 3 s apart."""
    return Realism(gusts=Gusts(force_n=force_n, duration_s=0.2, at_s=(0.0, 3.0), every_s=3.0, direction_deg=AROUND))


DISTURBANCES: Final[dict[str, Realism]] = {
    "none": Realism(),
    "foot friction 0.3": Realism(foot_friction=0.3),
    "motor strength 0.6": Realism(motor_strength=0.6),
    "latency 60 ms": Realism(command_latency_s=0.06),
    "payload 10 kg": Realism(payload_kg=10.0),
    "slope 5": Realism(slope_deg=5.0, uphill_deg=AROUND),
    "gusts 100 N": gusts(100.0),
    "tiles 2 cm": Realism(floor=FloorTiles(height_m=0.02)),
}


def main(config: Config) -> None:
    """Walk and push with each disturbance, and report what was measured."""
    seeds = range(config.first_seed, config.first_seed + config.seeds)
    found, kept = {}, Kept("disturbances", Path(__file__).parent)
    for name, realism in DISTURBANCES.items():
        walk, push = partial(curved_walk, realism=realism), partial(pushes, mass_kg=MASS_KG, realism=realism)
        key = f"{name}, {config.seeds} from {config.first_seed}"
        walking = kept.result(f"{key}, walking", dict[str, Any], partial(_summary, walk, seeds))
        pushing = kept.result(f"{key}, pushing", dict[str, Any], partial(_summary, push, seeds))
        found[name] = {"walking": walking, "pushing": pushing}
        print(name, walking, flush=True)
    write_report("disturbances", {"n": config.seeds, "first_seed": config.first_seed, "disturbances": found})


def _summary(run: Callable[..., Done], seeds: range) -> dict[str, Any]:
    """Carry out a run for each seed, and sum up what was measured."""
    return summary([run(seed) for seed in seeds])


if __name__ == "__main__":
    main(tyro.cli(Config))
