"""`python -m benchmarks.robot.sensitivity`: how walks and pushes depend on the numbers of physics and servos.

One number of the model is changed at a time. The numbers go to `results/model_sensitivity.json`.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np
import tyro
from msgspec.structs import replace

from benchmarks.report import write_report
from benchmarks.robot.alterations import altered
from benchmarks.robot.motions import curved_walk, pushes, summary
from legpush.scene.robot import RobotSpec
from sim_proc.headless import mujoco

MASSES_KG: Final = (0.1, 5.0)


@dataclass(frozen=True, kw_only=True)
class Config:
    """How often to walk and push."""

    seeds: int = 6
    """Number of walks, and of boxes of each mass, with each model."""
    first_seed: int = 900
    variants: tuple[str, ...] = ()
    """Names of the models; all if none is given."""


def _as_it_is(model: mujoco.MjModel) -> None:
    """Change nothing."""


def _option(name: str, value: float) -> Callable[[mujoco.MjModel], None]:
    def alter(model: mujoco.MjModel) -> None:
        setattr(model.opt, name, value)

    return alter


def _contacts(time_constant_s: float) -> Callable[[mujoco.MjModel], None]:
    """Change the time constant of the listed contacts."""

    def alter(model: mujoco.MjModel) -> None:
        model.pair_solref[:, 0] = time_constant_s

    return alter


def _impedance(first: float, last: float) -> Callable[[mujoco.MjModel], None]:
    """Change the impedance of the listed contacts at the surface and within."""

    def alter(model: mujoco.MjModel) -> None:
        model.pair_solimp[:, :2] = np.array([first, last])

    return alter


def _gains(position_n_m_rad: float, velocity_n_m_s_rad: float) -> RobotSpec:
    robot = RobotSpec()
    joints = {
        name: replace(
            getattr(robot.joints, name),
            position_gain_n_m_rad=position_n_m_rad,
            velocity_gain_n_m_s_rad=velocity_n_m_s_rad,
        )
        for name in ("hip_x", "hip_y", "knee")
    }
    return replace(robot, joints=replace(robot.joints, **joints))


MODELS: Final[dict[str, tuple[Callable[[mujoco.MjModel], None], int]]] = {
    "as it is": (_as_it_is, 1),
    "time step 1 ms": (_as_it_is, 2),
    "time step 0.5 ms": (_as_it_is, 4),
    "solver CG": (_option("solver", mujoco.mjtSolver.mjSOL_CG), 1),
    "pyramidal friction": (_option("cone", mujoco.mjtCone.mjCONE_PYRAMIDAL), 1),
    "impratio 10": (_option("impratio", 10.0), 1),
    "contact time constant 4 ms": (_contacts(0.004), 1),
    "contact time constant 4 ms, time step 1 ms": (_contacts(0.004), 2),
    "contact time constant 12 ms": (_contacts(0.012), 1),
    "contact time constant 20 ms": (_contacts(0.020), 1),
    "contact impedance 0.95 to 0.99": (_impedance(0.95, 0.99), 1),
}
"""Changes of the model, and physics steps per command."""
SERVOS: Final = {
    "gains 500 and 40": _gains(500.0, 40.0),
    "gains 250 and 15": _gains(250.0, 15.0),
    "gains 60 and 1.5": _gains(60.0, 1.5),
}


def main(config: Config) -> None:
    """Walk and push with each model, and report what was measured."""
    seeds = range(config.first_seed, config.first_seed + config.seeds)
    variants = {name: (*model, RobotSpec()) for name, model in MODELS.items()}
    variants |= {name: (_as_it_is, 1, robot) for name, robot in SERVOS.items()}
    models = {}
    for name, (alter, steps_per_command, robot) in variants.items():
        if config.variants and name not in config.variants:
            continue
        with altered(alter, steps_per_command):
            numbers = {"walking": summary([curved_walk(seed, robot) for seed in seeds])}
            for mass_kg in MASSES_KG:
                numbers[f"{mass_kg:g}"] = summary([pushes(seed, mass_kg, robot=robot) for seed in seeds])
        models[name] = numbers
        print(name, numbers["walking"])
    write_report("model_sensitivity", {"n": config.seeds, "first_seed": config.first_seed, "models": models})


if __name__ == "__main__":
    main(tyro.cli(Config))
