"""Renders single frames of a film off screen with MuJoCo."""

from dataclasses import dataclass
from itertools import pairwise
from math import degrees
from typing import Final

import mujoco
import numpy as np
from numpy.typing import NDArray

from sim_proc.film import Film
from sim_proc.model import build_model
from sim_proc.scenery import wall_name

DISTANCE_M: Final = 3.3
ELEVATION_DEG: Final = -28.0
OFF_HEADING_DEG: Final = 65.0
"""The camera looks along the robot's heading, turned by this much: from the right, a little behind."""
AHEAD_M: Final = 0.35
"""It looks at a point this far ahead of the robot."""
LOOK_HEIGHT_M: Final = 0.2
PATH_GREEN: Final = (0.10, 0.55, 0.30, 0.8)
FRONT_RED: Final = (0.80, 0.24, 0.18, 0.6)
REAR_BLUE: Final = (0.16, 0.36, 0.62, 0.6)
PATH_WIDTH_M: Final = 0.012
FOOTPRINT_RADIUS_M: Final = 0.025


@dataclass(frozen=True, kw_only=True)
class FrameSize:
    """Pixels of a frame."""

    width: int = 854
    height: int = 480


class Camera:
    """Follows the robot of one film."""

    def __init__(self, film: Film, size: FrameSize) -> None:
        """Compile the film's world and open an off-screen OpenGL context."""
        self._film = film
        self._model = build_model(film.scenario)
        self._data = mujoco.MjData(self._model)
        self._renderer = mujoco.Renderer(self._model, size.height, size.width)
        self._camera = mujoco.MjvCamera()
        self._camera.distance = DISTANCE_M
        self._camera.elevation = ELEVATION_DEG

    def frame(self, tick: int) -> NDArray[np.uint8]:
        """The world at a tick, (height, width, 3)."""
        film = self._film
        self._data.qpos[:] = film.qpos[tick]
        for index, row in film.hidden_until.items():
            self._model.geom(wall_name(index)).rgba[3] = float(row is not None and row <= tick)
        mujoco.mj_forward(self._model, self._data)
        heading = film.heading_rad[tick]
        ahead = AHEAD_M * np.array([np.cos(heading), np.sin(heading)])
        self._camera.lookat[:] = [*(film.trunk_m[tick] + ahead), LOOK_HEIGHT_M]
        self._camera.azimuth = degrees(heading) + OFF_HEADING_DEG
        self._renderer.update_scene(self._data, self._camera)
        self._add_marks(tick)
        pixels: NDArray[np.uint8] = self._renderer.render()
        return pixels

    def _add_marks(self, tick: int) -> None:
        scene = self._renderer.scene
        followed = [points for since, points in self._film.paths_m if since <= tick]
        if followed:
            moved = np.linalg.norm(np.diff(followed[-1], axis=0), axis=1) > 1e-6
            points = followed[-1][np.concatenate([[True], moved])][::2]
            for start, end in pairwise(points):
                geom = self._next_geom(scene, mujoco.mjtGeom.mjGEOM_CAPSULE, PATH_GREEN)
                if geom is None:
                    return
                mujoco.mjv_connector(
                    geom,
                    mujoco.mjtGeom.mjGEOM_CAPSULE,
                    PATH_WIDTH_M,
                    np.array([*start, 0.0]),
                    np.array([*end, 0.0]),
                )
        for mark in self._film.footprints:
            if mark.tick <= tick:
                geom = self._next_geom(scene, mujoco.mjtGeom.mjGEOM_CYLINDER, FRONT_RED if mark.front else REAR_BLUE)
                if geom is None:
                    return
                geom.pos[:] = [*mark.position_m, 0.001]
                geom.size[:] = [FOOTPRINT_RADIUS_M, FOOTPRINT_RADIUS_M, 0.001]

    @staticmethod
    def _next_geom(
        scene: mujoco.MjvScene, kind: mujoco.mjtGeom, rgba: tuple[float, float, float, float]
    ) -> mujoco.MjvGeom | None:
        """One more geom of the scene; None when it is full."""
        if scene.ngeom >= scene.maxgeom:
            return None
        geom = scene.geoms[scene.ngeom]
        mujoco.mjv_initGeom(geom, kind, np.zeros(3), np.zeros(3), np.eye(3).ravel(), np.array(rgba, dtype=np.float32))
        geom.category = mujoco.mjtCatBit.mjCAT_DECOR
        scene.ngeom += 1
        return geom
