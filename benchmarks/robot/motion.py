"""`python -m benchmarks.robot.motion`: torques, landings and margins of walks and pushes, at every physics step.

The robot walks along curves on an open floor, and pushes boxes of several masses. The numbers go to
`results/robot_motion.json`.
"""

from dataclasses import dataclass
from typing import Final

import tyro

from benchmarks.report import write_report
from benchmarks.robot.motions import curved_walk, pushes, summary

MASSES_KG: Final = (0.1, 1.0, 5.0)


@dataclass(frozen=True, kw_only=True)
class Config:
    """How often to walk and push."""

    seeds: int = 20
    """Number of walks, and of boxes of each mass, each of which is pushed four times."""
    first_seed: int = 500


def main(config: Config) -> None:
    """Walk and push, and report what was measured."""
    seeds = range(config.first_seed, config.first_seed + config.seeds)
    walking = summary([curved_walk(seed) for seed in seeds])
    pushing = {f"{mass_kg:g}": summary([pushes(seed, mass_kg) for seed in seeds]) for mass_kg in MASSES_KG}
    write_report("robot_motion", {"first_seed": config.first_seed, "walking": walking, "pushing": pushing})


if __name__ == "__main__":
    main(tyro.cli(Config))
