"""The scene of the page: bodies, lines and arrows, in handles that are updated and seldom recreated."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, Final

import numpy as np
import viser

from legpush.arrays import Floats
from legpush.history.run_history import RunHistory
from legpush.history.timeline import TRUNK, Timeline
from legpush.scene.conventions import CONTROL_PERIOD_S
from sim_proc.scene_3d import overlays
from sim_proc.scene_3d.bodies import Bodies

Rgb = tuple[int, int, int]

WORLD: Final = "/world"
"""Frame of everything. It moves while the view follows the robot."""
FLOOR: Final[Rgb] = (233, 236, 240)
TREE_GREY: Final[Rgb] = (150, 165, 185)
TRUNK_GREEN: Final[Rgb] = (24, 140, 80)
BOX_PURPLE: Final[Rgb] = (126, 70, 170)
CURVE_RED: Final[Rgb] = (214, 60, 45)
FORCE_ORANGE: Final[Rgb] = (235, 130, 20)
SUPPORT_BLUE: Final[Rgb] = (35, 105, 200)
COM_BLACK: Final[Rgb] = (30, 30, 35)
FEET: Final[tuple[Rgb, ...]] = ((205, 60, 45), (235, 140, 60), (40, 90, 160), (90, 160, 215))
"""Colours of the traces of FL, FR, RL, RR."""
LAYERS: Final = {
    "tree": "Search tree",
    "paths": "Paths",
    "traces": "Traces",
    "curve": "Push curve",
    "forces": "Forces",
    "support": "Support, ZMP",
}
"""Layers that can be hidden, and their labels."""
SHORTEST_M: Final = 0.005
"""Shorter arrows are hidden."""
BELOW_M: Final = -100.0
"""Height at which hidden arrows are kept."""
SMOOTHING: Final = 0.15
"""Share of the way to the robot that the view moves per update."""


class Scene:
    """Draws one timeline. All calls must come from one thread."""

    def __init__(self, server: viser.ViserServer, root: str = WORLD) -> None:
        """Set up an empty scene; the one at `WORLD` has the lights. Scenes beside it have other roots."""
        self._server = server
        self._root = root
        self._aside_m = 0.0
        self._bodies: Bodies | None = None
        self._handles: dict[str, list[Any]] = {}
        self._poses: dict[str, tuple[bytes, bytes]] = {}
        self._drawn: dict[str, object] = {}
        """Key of the data that each seldom changing part was drawn from."""
        self._layers: dict[str, Any] = {}
        self._shown = dict.fromkeys(LAYERS, True)
        self._centre_m: Floats | None = None
        self._world = server.scene.add_frame(root, show_axes=False)
        if root != WORLD:
            return
        server.scene.set_up_direction("+z")
        # A page without a GPU would spend most of its time on the default environment map, a photograph as light.
        server.scene.configure_environment_map(None)
        server.scene.configure_default_lights(enabled=False)
        server.scene.add_light_ambient("/sky", intensity=1.5)
        server.scene.add_light_directional("/fill", intensity=0.7, position=(3.0, 4.0, 3.0), cast_shadow=False)
        server.scene.add_light_directional("/sun", intensity=2.0, position=(-2.0, -3.0, 6.0), cast_shadow=False)

    def show_layer(self, name: str, shown: bool) -> None:
        """Show or hide one of `LAYERS`."""
        self._shown[name] = shown
        if name in self._layers:
            self._layers[name].visible = shown

    def begin(self, timeline: Timeline, aside_m: float = 0.0) -> None:
        """Begin to draw another episode, `aside_m` to the side along the x axis of the world."""
        scene = self._server.scene
        self._aside_m = aside_m
        with self._server.atomic():
            for handle in [*(each for some in self._handles.values() for each in some), *self._layers.values()]:
                handle.remove()
            self._handles.clear()
            self._poses.clear()
            self._drawn.clear()
            self._bodies = Bodies(timeline.scenario, timeline.reality)
            self._centre_m = None
            width, depth = timeline.scenario.room.size_m
            floor = scene.add_grid(
                f"{self._root}/floor",
                width=width,
                height=depth,
                cell_size=0.5,
                section_size=1.0,
                cell_color=(214, 218, 224),
                section_color=(190, 196, 205),
                plane_color=FLOOR,
                plane_opacity=1.0,
                shadow_opacity=0.0,
                position=(width / 2, depth / 2, -0.002),
            )
            self._handles["floor"] = [floor]
            for body in self._bodies.all:
                self._handles[body.name] = [
                    scene.add_mesh_trimesh(f"{self._root}/bodies/{body.name}", body.mesh, cast_shadow=False)
                ]
            self._layers = {name: scene.add_frame(f"{self._root}/{name}", show_axes=False) for name in LAYERS}
            for name, shown in self._shown.items():
                self._layers[name].visible = shown
            self._add_fast_overlays()

    def show(
        self, history: RunHistory, timeline: Timeline, row: int, *, follow: bool, centre_m: Floats | None = None
    ) -> None:
        """Draw a row. With `follow` the world moves so that the robot, or else `centre_m`, stays in the middle."""
        with self._server.atomic():
            self._move_bodies(timeline, row)
            middle_m = timeline.qpos[row, TRUNK][:2] if centre_m is None else centre_m
            self._follow(middle_m if follow else np.zeros(2))
            self._show_push(timeline, row)
            self._show_paths(history, timeline, row)
            self._box_trace(timeline, row)
            for layer, show in (
                ("traces", self._show_traces),
                ("forces", self._show_forces),
                ("support", self._show_support),
            ):
                if self._shown[layer]:
                    with self._redrawn(layer, (id(timeline), row)) as draw:
                        if draw:
                            show(timeline, row)
        self._server.flush()

    def _move_bodies(self, timeline: Timeline, row: int) -> None:
        """Move the bodies to their poses at a row, and hide obstacles that have not appeared yet."""
        if self._bodies is None:
            return
        positions, quaternions = self._bodies.poses(timeline.qpos[row])
        appeared = timeline.steps[-1].world.appeared
        for body in self._bodies.all:
            position, quaternion = positions[body.index], quaternions[body.index]
            pose = (position.tobytes(), quaternion.tobytes())
            moved = self._poses.get(body.name) != pose
            self._poses[body.name] = pose
            for handle in self._handles[body.name]:
                if moved:
                    handle.position, handle.wxyz = position, quaternion
                if body.appears:
                    handle.visible = self._bodies.is_there(body, appeared, timeline.tick[row])

    def _follow(self, centre_m: Floats) -> None:
        """Follow a place by moving the world. The cameras belong to the users."""
        before = self._centre_m
        self._centre_m = centre_m if before is None else before + SMOOTHING * (centre_m - before)
        if before is None or np.abs(self._centre_m - before).max() > 1e-5:
            self._world.position = (self._aside_m - self._centre_m[0], -self._centre_m[1], 0.0)

    def _add_fast_overlays(self) -> None:
        """Create the parts that change with every row, in handles of a fixed size."""
        scene, nothing = self._server.scene, np.zeros((4, 2, 3), dtype=np.float32)
        n_trail = overlays.TRAIL_ROWS // overlays.TRAIL_STRIDE
        self._forces = scene.add_arrows(
            f"{self._root}/forces/arrows",
            nothing,
            FORCE_ORANGE,
            shaft_radius=0.008,
            head_radius=0.02,
            head_length=0.04,
        )
        self._support = scene.add_line_segments(
            f"{self._root}/support/polygon", nothing, SUPPORT_BLUE, thickness=4.0, thickness_units="screen"
        )
        self._zmp = scene.add_icosphere(
            f"{self._root}/support/zmp", radius=0.018, color=SUPPORT_BLUE, cast_shadow=False
        )
        self._com = scene.add_icosphere(
            f"{self._root}/support/com", radius=0.018, color=(30, 30, 35), cast_shadow=False
        )
        colors = np.repeat(np.array(FEET, dtype=np.uint8), n_trail, axis=0)
        self._traces = scene.add_line_segments(
            f"{self._root}/traces/feet",
            np.zeros((4 * n_trail, 2, 3), dtype=np.float32),
            np.repeat(colors[:, None], 2, axis=1),
            thickness=2.5,
            thickness_units="screen",
        )

    def _show_traces(self, timeline: Timeline, row: int) -> None:
        self._traces.points = overlays.foot_traces(timeline, row).reshape(-1, 2, 3).astype(np.float32)

    def _show_forces(self, timeline: Timeline, row: int) -> None:
        arrows = overlays.contact_arrows(timeline, row)
        arrows[np.linalg.norm(arrows[:, 1] - arrows[:, 0], axis=1) < SHORTEST_M] = BELOW_M
        self._forces.points = arrows.astype(np.float32)

    def _show_support(self, timeline: Timeline, row: int) -> None:
        corners = overlays.support_polygon(timeline, row)
        lines = np.zeros((4, 2, 3), dtype=np.float32)
        if len(corners) > 1:
            ring = overlays.segments(np.vstack([corners, corners[:1]]))
            lines[: len(ring)] = ring
            lines[len(ring) :] = ring[-1, 1]
        self._support.points = lines
        for handle, point in ((self._zmp, timeline.zmp_m[row]), (self._com, timeline.com_m[row, :2])):
            known = bool(np.isfinite(point).all())
            handle.visible = known
            if known:
                handle.position = (float(point[0]), float(point[1]), 0.02)

    def _show_push(self, timeline: Timeline, row: int) -> None:
        """Draw the curve of the push at a row."""
        step = timeline.step_at(row)
        with self._redrawn("curve", (id(timeline), step.number)) as draw:
            curve = overlays.push_curve(timeline, step) if draw else None
            if curve is not None:
                self._lines("curve/curve", overlays.segments(curve.points_m), CURVE_RED, 4.0)
                self._lines("curve/polygon", overlays.segments(curve.control_m), CURVE_RED, 1.5)
                self._points("curve/points", curve.control_m, CURVE_RED)
            elif draw:
                self._forget("curve/curve", "curve/polygon", "curve/points")

    def _show_paths(self, history: RunHistory, timeline: Timeline, row: int) -> None:
        """Draw the plans that exist at a row, and the path that is followed."""
        for kind, color in (("trunk", TRUNK_GREEN), ("box", BOX_PURPLE)):
            plan = overlays.plan_at(history, timeline, row, kind)
            with self._redrawn(f"{kind} plan", id(plan)) as draw:
                if draw:
                    tree = None if plan is None else overlays.plan_tree(plan)
                    path = None if plan is None else overlays.segments(overlays.plan_path(plan))
                    self._lines_or_none(f"tree/{kind}", tree, TREE_GREY, 1.0)
                    self._lines_or_none(f"paths/{kind}", path, color, 3.0)
        step = timeline.step_at(row)
        with self._redrawn("followed", (id(timeline), step.number)) as draw:
            if draw:
                path = overlays.segments(overlays.followed_path(timeline, row))
                self._lines_or_none("paths/followed", path, TRUNK_GREEN, 5.0)

    def _box_trace(self, timeline: Timeline, row: int) -> None:
        every = round(0.5 / CONTROL_PERIOD_S)
        with self._redrawn("box trace", (id(timeline), timeline.tick[row] // every)) as draw:
            if draw:
                trace = overlays.segments(overlays.box_trace(timeline, row))
                self._lines_or_none("traces/box", trace, BOX_PURPLE, 2.0)

    @contextmanager
    def _redrawn(self, what: str, source: object) -> Iterator[bool]:
        """Yield whether a part has to be redrawn because its source has changed."""
        yield self._drawn.get(what) != source
        self._drawn[what] = source

    def _lines_or_none(self, name: str, lines: Floats | None, color: Rgb, thickness: float) -> None:
        if lines is None or not len(lines):
            self._forget(name)
        else:
            self._lines(name, lines, color, thickness)

    def _lines(self, name: str, lines: Floats, color: Rgb, thickness: float) -> None:
        self._handles[name] = [
            self._server.scene.add_line_segments(
                f"{self._root}/{name}", lines.astype(np.float32), color, thickness=thickness, thickness_units="screen"
            )
        ]

    def _points(self, name: str, points_m: Floats, color: Rgb) -> None:
        self._handles[name] = [
            self._server.scene.add_point_cloud(
                f"{self._root}/{name}", points_m.astype(np.float32), color, point_size=0.016, point_shape="circle"
            )
        ]

    def _forget(self, *names: str) -> None:
        for name in names:
            for handle in self._handles.pop(name, ()):
                handle.remove()
