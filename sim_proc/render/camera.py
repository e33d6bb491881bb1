"""Renders frames of a film off screen with MuJoCo."""

from dataclasses import dataclass
from itertools import pairwise
from math import degrees
from typing import Final

import mujoco
import numpy as np
from numpy.typing import NDArray

from legpush.options.formats import View
from sim_proc.model.scenery import wall_name
from sim_proc.model.world import build_model
from sim_proc.render.film import Film
from sim_proc.render.views import FIELD_OF_VIEW_RAD, FROM_ABOVE, look

PATH_GREEN: Final = (0.10, 0.55, 0.30, 0.8)
FRONT_RED: Final = (0.80, 0.24, 0.18, 0.6)
REAR_BLUE: Final = (0.16, 0.36, 0.62, 0.6)
PATH_WIDTH_M: Final = 0.012
FOOTPRINT_RADIUS_M: Final = 0.025
SUN_M: Final = 8.0
"""Distance of the light from the point that a camera looks at."""
SHADOWS_M: Final = 8.0
"""Shadows are drawn at least this far around the point that a camera looks at."""


@dataclass(frozen=True, kw_only=True)
class FrameSize:
    """Size of a frame in pixels."""

    width: int = 854
    height: int = 480


class Camera:
    """Renders one film from one view."""

    def __init__(self, film: Film, size: FrameSize, view: View = "follow") -> None:
        """Compile the film's world and open an off-screen OpenGL context."""
        self._film = film
        self._view: View = view
        self._aspect = size.width / size.height
        self._model = build_model(film.scenario, film.reality)
        visual = self._model.vis.global_
        if view in FROM_ABOVE:  # the floor would reflect a light beside the camera and look white
            self._model.vis.headlight.diffuse[:] = 0.05
            self._model.vis.headlight.specular[:] = 0.0
            self._model.light_diffuse[:] *= 0.8
        visible = self._model.vis.map
        visible.shadowclip = max(visible.shadowclip, SHADOWS_M / self._model.stat.extent)
        visual.fovy = degrees(FIELD_OF_VIEW_RAD)
        visual.offwidth, visual.offheight = max(visual.offwidth, size.width), max(visual.offheight, size.height)
        self._data = mujoco.MjData(self._model)
        self._renderer = mujoco.Renderer(self._model, size.height, size.width)
        self._camera = mujoco.MjvCamera()

    def frame(self, row: int) -> NDArray[np.uint8]:
        """The world at a row of the film, (height, width, 3)."""
        film = self._film
        self._data.qpos[:] = film.qpos[row]
        for index, since in film.hidden_until.items():
            self._model.geom(wall_name(index)).rgba[3] = float(since is not None and since <= row)
        place = look(film, self._view, row, self._aspect)
        # The position of a directional light only centres its shadows, which are coarse at their border.
        self._model.light_pos[0] = place.at_m - SUN_M * self._model.light_dir[0]
        mujoco.mj_forward(self._model, self._data)
        self._camera.lookat[:] = place.at_m
        self._camera.distance = place.distance_m
        self._camera.azimuth, self._camera.elevation = degrees(place.azimuth_rad), degrees(place.elevation_rad)
        self._renderer.update_scene(self._data, self._camera)
        self._add_marks(row)
        pixels: NDArray[np.uint8] = self._renderer.render()
        return pixels

    def close(self) -> None:
        """Release the OpenGL context."""
        self._renderer.close()

    def _add_marks(self, row: int) -> None:
        """Add the path that is followed at a row, and the footprints up to it."""
        scene = self._renderer.scene
        followed = [points for since, points in self._film.paths_m if since <= row]
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
            if mark.row <= row:
                geom = self._next_geom(scene, mujoco.mjtGeom.mjGEOM_CYLINDER, FRONT_RED if mark.front else REAR_BLUE)
                if geom is None:
                    return
                geom.pos[:] = [*mark.position_m, 0.001]
                geom.size[:] = [FOOTPRINT_RADIUS_M, FOOTPRINT_RADIUS_M, 0.001]

    @staticmethod
    def _next_geom(
        scene: mujoco.MjvScene, kind: mujoco.mjtGeom, rgba: tuple[float, float, float, float]
    ) -> mujoco.MjvGeom | None:
        """Add a geom to the scene; None when the scene is full."""
        if scene.ngeom >= scene.maxgeom:
            return None
        geom = scene.geoms[scene.ngeom]
        mujoco.mjv_initGeom(geom, kind, np.zeros(3), np.zeros(3), np.eye(3).ravel(), np.array(rgba, dtype=np.float32))
        geom.category = mujoco.mjtCatBit.mjCAT_DECOR
        scene.ngeom += 1
        return geom
