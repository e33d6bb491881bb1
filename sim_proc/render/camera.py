"""Draws frames of a film off screen with MuJoCo.

Without a GPU the processor draws every pixel and every facet, so a frame is as cheap as its contents: no multisampling
(a film is drawn larger and scaled down), few facets for round bodies, and a path of flat boxes instead of capsules.
"""

from dataclasses import dataclass
from itertools import pairwise
from math import atan2, cos, degrees, hypot, sin
from typing import Final

import mujoco
import numpy as np
from numpy.typing import NDArray

from legpush.options.formats import View
from sim_proc.model.scenery import wall_name
from sim_proc.model.world import build_model
from sim_proc.render.caption import caption
from sim_proc.render.film import Film
from sim_proc.render.views import FIELD_OF_VIEW_RAD, FROM_ABOVE, look

PATH_GREEN: Final = (0.10, 0.55, 0.30, 0.8)
FRONT_RED: Final = (0.80, 0.24, 0.18, 0.6)
REAR_BLUE: Final = (0.16, 0.36, 0.62, 0.6)
PATH_HALF_WIDTH_M: Final = 0.012
MARK_HALF_HEIGHT_M: Final = 0.001
FOOTPRINT_RADIUS_M: Final = 0.025
SUN_M: Final = 8.0
"""Distance of the light from the point that a camera looks at."""
SHADOWS_M: Final = 8.0
"""Shadows are drawn at least this far around the point that a camera looks at."""
SHADOW_PIXELS: Final = 3072
"""Side of the map of shadows."""
SLICES: Final = 18
STACKS: Final = 10
"""Facets around a round body, and along it."""
MAX_GEOMS: Final = 10_000
"""Most bodies and marks in a frame."""
FONT_SCALES: Final = (50, 100, 150, 200, 250, 300)
HEIGHT_AT_100: Final = 480
"""Height of a frame in which text of scale 100 reads well, in pixels."""


@dataclass(frozen=True, kw_only=True)
class FrameSize:
    """Size of a frame in pixels."""

    width: int = 854
    height: int = 480


class Camera:
    """Draws one film from one view."""

    def __init__(self, film: Film, size: FrameSize, view: View = "follow", speed: float | None = None) -> None:
        """Compile the film's world and open an off-screen OpenGL context.

        With `speed`, the times real time at which the film is shown, each frame gets a caption.
        """
        self._film = film
        self._view: View = view
        self._speed = speed
        self._aspect = size.width / size.height
        self._model = build_model(film.scenario, film.reality)
        self._set_quality(size, view)
        self._data = mujoco.MjData(self._model)
        self._camera = mujoco.MjvCamera()
        self._options = mujoco.MjvOption()
        self._scene = mujoco.MjvScene(self._model, maxgeom=MAX_GEOMS)
        self._viewport = mujoco.MjrRect(0, 0, size.width, size.height)
        self._gl = mujoco.GLContext(size.width, size.height)
        self._gl.make_current()
        self._context = mujoco.MjrContext(self._model, _font_scale(size.height))
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN, self._context)
        self._pixels: NDArray[np.uint8] = np.empty((size.height, size.width, 3), dtype=np.uint8)

    def _set_quality(self, size: FrameSize, view: View) -> None:
        """Set what decides about the cost and the look of a frame."""
        visual, quality = self._model.vis.global_, self._model.vis.quality
        if view in FROM_ABOVE:  # the floor would reflect a light beside the camera and look white
            self._model.vis.headlight.diffuse[:] = 0.05
            self._model.vis.headlight.specular[:] = 0.0
            self._model.light_diffuse[:] *= 0.8
        visible = self._model.vis.map
        visible.shadowclip = max(visible.shadowclip, SHADOWS_M / self._model.stat.extent)
        visual.fovy = degrees(FIELD_OF_VIEW_RAD)
        visual.offwidth, visual.offheight = size.width, size.height
        quality.shadowsize, quality.offsamples = SHADOW_PIXELS, 0
        quality.numslices, quality.numstacks, quality.numquads = SLICES, STACKS, 1

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
        mujoco.mjv_updateScene(
            self._model, self._data, self._options, None, self._camera, mujoco.mjtCatBit.mjCAT_ALL, self._scene
        )
        self._add_marks(row)
        mujoco.mjr_render(self._viewport, self._scene, self._context)
        if self._speed is not None:
            self._write(caption(film, row, self._speed))
        mujoco.mjr_readPixels(self._pixels, None, self._viewport, self._context)
        return self._pixels[::-1]

    def show(self, film: Film) -> None:
        """Draw another film of the same scenario and reality from now on."""
        self._film = film

    def close(self) -> None:
        """Release the OpenGL context."""
        self._context.free()
        self._gl.free()

    def _write(self, lines: tuple[tuple[str, str], ...]) -> None:
        """Write titles and values into the upper left corner."""
        titles, values = ("\n".join(column) for column in zip(*lines, strict=True))
        mujoco.mjr_overlay(
            mujoco.mjtFont.mjFONT_NORMAL,
            mujoco.mjtGridPos.mjGRID_TOPLEFT,
            self._viewport,
            titles,
            values,
            self._context,
        )

    def _add_marks(self, row: int) -> None:
        """Add the path that is followed at a row, and the footprints up to it."""
        followed = [points for since, points in self._film.paths_m if since <= row]
        if followed:
            moved = np.linalg.norm(np.diff(followed[-1], axis=0), axis=1) > 1e-6
            points = followed[-1][np.concatenate([[True], moved])][::2]
            for (x0, y0), (x1, y1) in pairwise(points.tolist()):
                half_m, yaw = hypot(x1 - x0, y1 - y0) / 2, atan2(y1 - y0, x1 - x0)
                if not self._add_geom(
                    mujoco.mjtGeom.mjGEOM_BOX,
                    (half_m, PATH_HALF_WIDTH_M, MARK_HALF_HEIGHT_M),
                    ((x0 + x1) / 2, (y0 + y1) / 2),
                    PATH_GREEN,
                    yaw,
                ):
                    return
        size = (FOOTPRINT_RADIUS_M, MARK_HALF_HEIGHT_M, 0.0)
        for mark in self._film.footprints:
            if mark.row <= row:
                colour = FRONT_RED if mark.front else REAR_BLUE
                if not self._add_geom(mujoco.mjtGeom.mjGEOM_CYLINDER, size, mark.position_m, colour):
                    return

    def _add_geom(
        self,
        kind: mujoco.mjtGeom,
        size_m: tuple[float, float, float],
        at_m: tuple[float, float] | NDArray[np.float64],
        rgba: tuple[float, float, float, float],
        yaw_rad: float = 0.0,
    ) -> bool:
        """Add a mark that lies on the floor; return False when the scene is full."""
        scene = self._scene
        if scene.ngeom >= scene.maxgeom:
            return False
        turn = np.array([cos(yaw_rad), -sin(yaw_rad), 0.0, sin(yaw_rad), cos(yaw_rad), 0.0, 0.0, 0.0, 1.0])
        geom = scene.geoms[scene.ngeom]
        mujoco.mjv_initGeom(
            geom,
            kind,
            np.array(size_m),
            np.array([*at_m, MARK_HALF_HEIGHT_M]),
            turn,
            np.array(rgba, dtype=np.float32),
        )
        geom.category = mujoco.mjtCatBit.mjCAT_DECOR
        scene.ngeom += 1
        return True


def _font_scale(height: int) -> int:
    """Return the scale of text that reads well in a frame of this height."""
    return min(FONT_SCALES, key=lambda scale: abs(scale - 100 * height / HEIGHT_AT_100))
