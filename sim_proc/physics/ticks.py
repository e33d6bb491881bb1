"""Runs the physics steps of ticks in one call of MuJoCo."""

from copy import deepcopy
from typing import Any, Final

import numpy as np

from legpush.arrays import Floats
from sim_proc.headless import mujoco

FULL_PHYSICS: Final = mujoco.mjtState.mjSTATE_FULLPHYSICS.value
INPUTS: Final = (
    mujoco.mjtState.mjSTATE_CTRL.value
    | mujoco.mjtState.mjSTATE_MOCAP_POS.value
    | mujoco.mjtState.mjSTATE_MOCAP_QUAT.value
)
"""What acts on the world from outside: controls, and the places of obstacles that appear later. A rollout sets what it
is not given to its default."""
ROLLOUT: Final = "_rollout"
FORCES: Final = mujoco.mjtState.mjSTATE_XFRC_APPLIED.value
"""Forces on bodies, such as gusts."""


class Ticks:
    """Runs ticks by MuJoCo's rollout: the same steps as those of `mj_step`, bit for bit, without Python in between."""

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, *, forces: bool = False) -> None:
        """Run the ticks of `data`. Forces on bodies act only with `forces`."""
        self.data = data
        self._inputs = INPUTS | FORCES if forces else INPUTS
        self._rollout = mujoco.rollout.Rollout(nthread=0)
        self._state = np.empty((1, mujoco.mj_stateSize(model, FULL_PHYSICS)))
        self._present = np.empty(mujoco.mj_stateSize(model, self._inputs))

    def __deepcopy__(self, memo: dict[int, Any]) -> "Ticks":
        """Copy all but the rollout of MuJoCo, which has no state of its own and cannot be copied."""
        copied = Ticks.__new__(Ticks)
        memo[id(self)] = copied
        vars(copied).update({name: deepcopy(value, memo) for name, value in vars(self).items() if name != ROLLOUT})
        setattr(copied, ROLLOUT, mujoco.rollout.Rollout(nthread=0))
        return copied

    def run(self, model: mujoco.MjModel, controls: Floats, sensors: Floats) -> Floats:
        """Run n ticks with controls (n, steps, nu), and fill in the sensors of their steps, (n, steps, nsensordata).

        Return `qpos` at the ends of the ticks, (n, nq). After a step with a warning nothing moves any more.
        """
        data, (n, n_steps, nu) = self.data, controls.shape
        mujoco.mj_getState(model, data, self._state[0], FULL_PHYSICS)
        mujoco.mj_getState(model, data, self._present, self._inputs)
        inputs = np.empty((1, n * n_steps, len(self._present)))
        inputs[0, :, :nu], inputs[0, :, nu:] = controls.reshape(-1, nu), self._present[nu:]
        states = np.empty((1, n * n_steps, self._state.shape[1]))
        self._rollout.rollout(
            [model],
            [data],
            self._state,
            inputs,
            control_spec=self._inputs,
            skip_checks=True,
            nstep=n * n_steps,
            initial_warmstart=data.qacc_warmstart[None],
            state=states,
            sensordata=sensors.reshape(1, n * n_steps, -1),
        )
        qpos: Floats = states[0, n_steps - 1 :: n_steps, 1 : 1 + model.nq]
        return qpos
