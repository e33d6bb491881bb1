"""Runs the physics steps of a tick in one call of MuJoCo."""

from typing import Final

import numpy as np
from mujoco.rollout import Rollout

from legpush.arrays import Floats
from sim_proc.control.joint_commands import COMMANDS_PER_TICK
from sim_proc.headless import mujoco

FULL_PHYSICS: Final = mujoco.mjtState.mjSTATE_FULLPHYSICS.value
INPUTS: Final = mujoco.mjtState.mjSTATE_USER.value
"""All that a user of MuJoCo sets, first of all the controls. A rollout sets what it is not given to defaults."""


class Ticks:
    """Runs ticks by MuJoCo's rollout: the same steps as those of `mj_step`, bit for bit, without Python in between."""

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        """Run the ticks of `data`."""
        self._data = [data]
        self._rollout = Rollout(nthread=0)
        self._state = np.empty((1, mujoco.mj_stateSize(model, FULL_PHYSICS)))
        self._inputs = np.empty((1, COMMANDS_PER_TICK, mujoco.mj_stateSize(model, INPUTS)))
        self._controls = self._inputs[0, :, : model.nu]

    def take_inputs(self, model: mujoco.MjModel) -> None:
        """Give the present inputs to all steps from now on, such as the places of mocap bodies."""
        mujoco.mj_getState(model, self._data[0], self._inputs[0, 0], INPUTS)
        self._inputs[0, 1:] = self._inputs[0, 0]

    def run(self, model: mujoco.MjModel, controls: Floats, sensors: Floats) -> None:
        """Run one tick with controls (steps, nu), and fill in the sensors of its steps, (steps, nsensordata)."""
        self._controls[:] = controls
        data = self._data[0]
        mujoco.mj_getState(model, data, self._state[0], FULL_PHYSICS)
        self._rollout.rollout(
            [model],
            self._data,
            self._state,
            self._inputs,
            control_spec=INPUTS,
            skip_checks=True,
            nstep=COMMANDS_PER_TICK,
            initial_warmstart=data.qacc_warmstart[None],
            sensordata=sensors[None],
        )
