"""Changes of the simulator that a benchmark makes from outside, for as long as it needs them."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager

import numpy as np

from legpush.arrays import Floats
from legpush.realism.reality import AS_ASSUMED, Reality
from legpush.scene.scenario import Scenario
from sim_proc.headless import mujoco
from sim_proc.model.world import build_model
from sim_proc.physics import physics
from sim_proc.physics.ticks import Ticks


@contextmanager
def altered(alter: Callable[[mujoco.MjModel], None], steps_per_command: int = 1) -> Iterator[None]:
    """Change each model that the simulator builds, and give each command for several physics steps.

    Sensors are those of the last of these steps.
    """
    step = mujoco.mj_step

    def build_altered(scenario: Scenario, reality: Reality = AS_ASSUMED) -> mujoco.MjModel:
        model = build_model(scenario, reality)
        model.opt.timestep /= steps_per_command
        alter(model)
        return model

    def step_often(model: mujoco.MjModel, data: mujoco.MjData) -> None:
        step(model, data, steps_per_command)

    vars(physics)["build_model"] = build_altered
    try:
        with stepped_by(step_often):
            yield
    finally:
        vars(physics)["build_model"] = build_model


@contextmanager
def stepped_by(replacement: Callable[[mujoco.MjModel, mujoco.MjData], None]) -> Iterator[None]:
    """Let the simulator call something else for `mj_step`, also in ticks that MuJoCo would run in one call."""
    step, run = mujoco.mj_step, Ticks.run

    def run_stepwise(self: Ticks, model: mujoco.MjModel, controls: Floats, sensors: Floats) -> Floats:
        data, qpos = self.data, np.empty((len(controls), model.nq))
        for k, row in enumerate(qpos):
            for control, readings in zip(controls[k], sensors[k], strict=True):
                data.ctrl[:] = control
                replacement(model, data)
                readings[:] = data.sensordata
            row[:] = data.qpos
        return qpos

    mujoco.mj_step = replacement
    Ticks.run = run_stepwise  # type: ignore[method-assign]
    try:
        yield
    finally:
        mujoco.mj_step = step
        Ticks.run = run  # type: ignore[method-assign]
