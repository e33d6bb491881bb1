"""`python -m benchmarks.robot.disturbances`: walks and pushes on a slippery floor, with weak servos, late, and loaded.

The controller knows none of it, except that its mass is that of the whole robot. The numbers go to
`results/disturbances.json`.
"""

from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from typing import Final

import tyro

from benchmarks.report import write_report
from benchmarks.robot.alterations import altered, delayed
from benchmarks.robot.motions import curved_walk, pushes, summary
from sim_proc.headless import mujoco
from sim_proc.model.world import PHYSICS_STEP_S

FOOT_FRICTION: Final = 0.3
STRENGTH: Final = 0.6
LATENCY_S: Final = 0.06
PAYLOAD_KG: Final = 10.0
MASS_KG: Final = 1.0
"""Of the box that is pushed."""


@dataclass(frozen=True, kw_only=True)
class Config:
    """How often to walk and push."""

    seeds: int = 20
    """Number of walks, and of boxes that are pushed four times, with each disturbance."""
    first_seed: int = 1100


def _slippery(model: mujoco.MjModel) -> None:
    """Lower the friction of feet and floor."""
    for index in range(model.npair):
        if model.pair(index).name.startswith("floor:") and model.pair(index).name.endswith("_foot"):
            model.pair_friction[index, :2] = FOOT_FRICTION


def _weak(model: mujoco.MjModel) -> None:
    """Scale gains and largest torques of all servos."""
    model.actuator_gainprm[:, 0] *= STRENGTH
    model.actuator_biasprm[:, 1:3] *= STRENGTH
    model.actuator_forcerange[:] *= STRENGTH


def _loaded(model: mujoco.MjModel) -> None:
    """Add a mass in the middle of the trunk."""
    model.body_mass[model.body("trunk").id] += PAYLOAD_KG
    mujoco.mj_setConst(model, mujoco.MjData(model))


DISTURBANCES: Final[dict[str, Callable[[], AbstractContextManager[None]]]] = {
    "none": nullcontext,
    "foot friction 0.3": lambda: altered(_slippery),
    "motor strength 0.6": lambda: altered(_weak),
    "latency 60 ms": lambda: delayed(round(LATENCY_S / PHYSICS_STEP_S)),
    "payload 10 kg": lambda: altered(_loaded),
}


def main(config: Config) -> None:
    """Walk and push with each disturbance, and report what was measured."""
    seeds = range(config.first_seed, config.first_seed + config.seeds)
    found = {}
    for name, disturbed in DISTURBANCES.items():
        with disturbed():
            walking = summary([curved_walk(seed) for seed in seeds])
            pushing = summary([pushes(seed, MASS_KG) for seed in seeds])
        found[name] = {"walking": walking, "pushing": pushing}
        print(name, walking)
    write_report("disturbances", {"n": config.seeds, "first_seed": config.first_seed, "disturbances": found})


if __name__ == "__main__":
    main(tyro.cli(Config))
