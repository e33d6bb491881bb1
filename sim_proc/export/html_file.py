"""Writes an episode as one HTML file that plays in a browser without a server: the client of viser, with its scene."""

from collections.abc import Callable
from contextlib import redirect_stdout
from io import StringIO
from itertools import pairwise
from pathlib import Path
from typing import Final

import numpy as np
import viser

from legpush.history.run_history import RunHistory
from legpush.history.timeline import TRUNK, Timeline
from legpush.scene.conventions import CONTROL_PERIOD_S
from sim_proc.scene_3d.port import free_port
from sim_proc.scene_3d.scene import Scene

HOST: Final = "127.0.0.1"
FRAMES_PER_S: Final = 10.0
"""Frames per simulated second."""
MOST_FRAMES: Final = 3000
"""A longer episode has fewer frames per second."""
LEFT_OUT: Final = ("traces", "forces", "support")
"""Layers that change with every row: they would be most of the file."""
BEHIND_M: Final = (-2.5, -3.5, 4.5)
"""Where the camera is at the beginning, from the place halfway between the start of the robot and the goal."""
SAY_EVERY: Final = 100
"""Frames between two reports of progress."""


def write_html(history: RunHistory, timeline: Timeline, path: Path, say: Callable[[int, int], None]) -> str:
    """Write the file and return a description of it in a few words.

    Raises:
        OSError: The file cannot be written.
    """
    rows = frame_rows(timeline)
    # The scene is recorded from the messages of a server that nobody connects to.
    with redirect_stdout(StringIO()):  # viser prints a banner
        server = viser.ViserServer(host=HOST, port=free_port(HOST), verbose=False)
    try:
        scene = Scene(server)
        for layer in LEFT_OUT:
            scene.show_layer(layer, False)
        scene.begin(timeline)
        _aim(server, timeline)
        scene.show(history, timeline, rows[0], follow=False)
        recorded = server.get_scene_serializer()
        for index, (before, row) in enumerate(pairwise(rows)):
            recorded.insert_sleep(float(timeline.time_s[row] - timeline.time_s[before]))
            scene.show(history, timeline, row, follow=False)
            if index % SAY_EVERY == 0:
                say(index, len(rows))
        text = recorded.as_html()
    finally:
        with redirect_stdout(StringIO()):
            server.stop()
    path.write_text(text, encoding="utf-8")
    say(len(rows), len(rows))
    return f"{len(rows)} frames, {timeline.time_s[-1] - timeline.time_s[0]:.1f} s, {len(text.encode()) / 1e6:.1f} MB"


def frame_rows(timeline: Timeline) -> list[int]:
    """The rows that are shown: evenly spaced, with the first and the last one."""
    every = max(round(1.0 / (FRAMES_PER_S * CONTROL_PERIOD_S)), -(-timeline.n_rows // MOST_FRAMES))
    return [*range(0, timeline.n_rows - 1, every), timeline.n_rows - 1]


def _aim(server: viser.ViserServer, timeline: Timeline) -> None:
    """Look at the middle between the start of the robot and the goal of the box."""
    goal = timeline.scenario.goal.pose
    middle = (timeline.qpos[0, TRUNK][:2] + np.array([goal.x_m, goal.y_m])) / 2
    away = max(1.0, float(np.linalg.norm(timeline.qpos[0, TRUNK][:2] - middle)) / 2.0)
    x_m, y_m, z_m = (away * offset for offset in BEHIND_M)
    server.initial_camera.position = (float(middle[0]) + x_m, float(middle[1]) + y_m, z_m)
    server.initial_camera.look_at = (float(middle[0]), float(middle[1]), 0.0)
