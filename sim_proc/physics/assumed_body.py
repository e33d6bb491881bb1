"""The robot as control takes it to be: its masses, in the posture that it really has."""

import numpy as np

from legpush.arrays import Floats
from legpush.scene.conventions import BOX_QPOS, LEGS
from sim_proc.headless import mujoco


class AssumedBody:
    """A model of the robot that may differ from the simulated one, and what control computes with it."""

    def __init__(self, model: mujoco.MjModel) -> None:
        """Use the masses and the gravity of `model`."""
        self.model = model
        self._data = mujoco.MjData(model)
        self._trunk = model.body("trunk").id
        self.downhill = downhill_of(model)
        """Where a plumb line from one metre above the floor meets it, relative to the point below that, [m/m], (2,)."""
        self.mass_kg = float(model.body_subtreemass[self._trunk])

    def moments(self) -> tuple[Floats, Floats]:
        """Mass, and mass times centre in its own frame, of the trunk, (4,), and of the links of the legs, (12, 4)."""
        model = self.model
        links = [model.body(f"{leg}_{part}").id for leg in LEGS for part in ("hip", "upper", "lower")]
        mass = model.body_mass[:, None]
        rows = np.concatenate([mass, mass * model.body_ipos], axis=1)
        return rows[self._trunk], rows[links]

    def com_m(self, qpos: Floats) -> Floats:
        """Centre of mass of the robot in a posture `qpos` (26,), (3,)."""
        self._data.qpos[: BOX_QPOS.stop] = qpos
        mujoco.mj_kinematics(self.model, self._data)
        mujoco.mj_comPos(self.model, self._data)
        com: Floats = np.array(self._data.subtree_com[self._trunk])
        return com


def downhill_of(model: mujoco.MjModel) -> Floats:
    """Where a plumb line from one metre above the floor meets it, relative to the point below that, [m/m], (2,)."""
    gravity = model.opt.gravity
    downhill: Floats = gravity[:2] / -gravity[2]
    return downhill
