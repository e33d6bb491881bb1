"""The bodies of a scenario's MuJoCo model as meshes, and where they are for given joint positions."""

from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np
from mjviser.conversions import group_geoms_by_visual_compat, merge_geoms
from numpy.typing import NDArray

from legpush.messages.stepping import Appearance
from legpush.scenario import Scenario
from sim_proc.model import build_model
from sim_proc.scenery import wall_name

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Body:
    """A rigid part of the scene."""

    name: str
    index: int
    """In the arrays of `Bodies.poses`."""
    meshes: tuple[Any, ...]
    """`trimesh.Trimesh` each, in the frame of the body."""
    moves: bool
    appears: bool
    """Whether it is an obstacle that is not there from the beginning."""


class Bodies:
    """Of one scenario."""

    def __init__(self, scenario: Scenario) -> None:
        """Compile the model."""
        self._model = build_model(scenario)
        self._data = mujoco.MjData(self._model)
        mujoco.mj_kinematics(self._model, self._data)
        self.all = tuple(filter(lambda body: body.meshes, map(self._body, range(self._model.nbody))))
        """Those that can be seen; the floor is not among them."""
        later = (index for index, wall in enumerate(scenario.room.obstacles) if wall.appears_at_s > 0.0)
        self._appearing = {wall_name(index): index for index in later}

    def poses(self, qpos: Array) -> tuple[Array, Array]:
        """Positions (n, 3) and quaternions (n, 4; w, x, y, z) of all bodies, world frame."""
        self._data.qpos[:] = qpos
        mujoco.mj_kinematics(self._model, self._data)
        return self._data.xpos.copy(), self._data.xquat.copy()

    def is_there(self, body: Body, appeared: tuple[Appearance, ...], tick: float) -> bool:
        """Whether it can be seen at a tick, given all that has appeared up to then or later."""
        return not body.appears or any(
            each.obstacle == self._appearing[body.name] and each.tick <= tick for each in appeared
        )

    def _body(self, index: int) -> Body:
        model = self._model
        geoms = [
            int(geom)
            for geom in np.flatnonzero(model.geom_bodyid == index)
            if model.geom_type[geom] != mujoco.mjtGeom.mjGEOM_PLANE and model.geom_rgba[geom, 3] > 0.0
        ]
        is_mocap = bool(model.body_mocapid[index] >= 0)
        return Body(
            name=model.body(index).name,
            index=index,
            meshes=tuple(merge_geoms(model, group) for group in group_geoms_by_visual_compat(model, geoms)),
            moves=bool(model.body_weldid[index]) and not is_mocap,
            appears=is_mocap,
        )
