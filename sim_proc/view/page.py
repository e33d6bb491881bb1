"""The page: a viser server on this machine, and the loop that shows the row chosen by the player."""

import threading
from collections.abc import Callable
from contextlib import redirect_stdout
from io import StringIO
from math import cos, sin
from time import monotonic, time_ns
from typing import Final

import numpy as np

from legpush.errors import ConfigError
from legpush.geometry import rpy_from_quaternion
from legpush.history.run_history import RunHistory
from legpush.history.timeline import BOX, TRUNK, Timeline
from legpush.options.view import EVERYWHERE
from sim_proc.scene_3d.port import free_port
from sim_proc.scene_3d.scene import LAYERS, Scene
from sim_proc.view.beside import GAP_M, Beside
from sim_proc.view.guard import start_server
from sim_proc.view.panel import CAMERAS, FOLLOW_ROBOT, Panel, PanelCommand, Viewpoint, speed_of
from sim_proc.view.player import Player
from sim_proc.view.plots import Plots
from sim_proc.view.source import PUMP_S, Source
from sim_proc.view.statuses import conditions

PERIOD_S: Final = 1 / 25
"""Period of the scene."""
TIME_PERIOD_S: Final = 0.12
"""Period of the slider and the text beside it."""
SLOW_PERIOD_S: Final = 0.5
"""Period of plots and statuses."""


class Page:
    """A page in the browser; a context manager that stops the server on exit."""

    def __init__(self, source: Source, host: str, port: int, beside: Source | None = None) -> None:
        """Start the server; port 0 takes any free port. The longest episode of `beside` is shown at equal times.

        Raises:
            ConfigError: The address cannot be listened on, or the page cannot be guarded.
        """
        port = free_port(host, port)
        self._source = source
        self._server, token = start_server(host, port)
        shown = "127.0.0.1" if host == EVERYWHERE else host
        self.url = f"http://{shown}:{self._server.get_port()}/?token={token}"
        """Address that opens the page; further fields of its query can follow after `&`."""
        self._server.gui.configure_theme(control_width="medium", show_logo=False, show_share_button=False)
        self._server.gui.main_panel.dock_right()
        self._server.initial_camera.position = CAMERAS["Behind"].position_m
        self._server.initial_camera.look_at = CAMERAS["Behind"].look_at_m
        self._server.initial_camera.fov = 0.75
        self._scene = Scene(self._server)
        self._beside = None if beside is None else Beside(self._server, beside)
        self._panel = Panel(self._server, live=source.is_live)
        panel = self._server.gui.add_panel()
        with panel.add_tab("Plots"):
            self._plots = Plots(self._server)
        panel.dock_left()
        self.history = RunHistory()
        self.shown: Timeline | None = None
        self._time_shown_at = self._slow_at = monotonic()
        self.player = Player(follows=source.is_live)
        self._follows_newest = True
        self._follows_robot = True

    def __enter__(self) -> "Page":
        return self

    def __exit__(self, *_: object) -> None:
        with redirect_stdout(StringIO()):
            self._server.stop()

    def run(self, stop: threading.Event) -> None:
        """Update the page until `stop` is set."""
        updated_at = monotonic()
        while not stop.is_set():
            began = monotonic()
            self.update(began - updated_at)
            updated_at = began
            stop.wait(max(0.0, PERIOD_S - (monotonic() - began)))

    def update(self, seconds: float) -> None:
        """Take new messages and commands and show the present row, `seconds` after the last update."""
        self._source.pump(self.history, PUMP_S)
        for command in self._panel.commands():
            self.obey(command)
        self._choose()
        if self._beside is not None:
            self._beside.pump()
        now = monotonic()
        if self.shown is not None:
            self.player.advance(seconds, self.shown, grows=self._source.is_reading)
            row = self.player.row(self.shown)
            if self._server.get_clients():
                self._scene.show(self.history, self.shown, row, follow=self._follows_robot)
                if self._beside is not None:
                    self._beside.show(self.shown, row, follow=self._follows_robot)
            if now - self._time_shown_at >= TIME_PERIOD_S:
                self._time_shown_at = now
                self._panel.show_time(self.shown, row, self.player)
        if now - self._slow_at >= SLOW_PERIOD_S:
            self._slow_at = now
            self._show_slow()

    def _show_slow(self) -> None:
        """Update plots, episodes and statuses."""
        at_ns = time_ns()
        if self.shown is not None:
            if self._beside is not None:
                self._aim_at_both()
            row = self.player.row(self.shown)
            self._plots.show(self.shown, row)
            if not self.player.follows:
                at_ns = self.shown.time_ns_at(row)
        live = self._source.live() if self.player.follows or self.shown is None else None
        if self.shown is None:
            self._panel.show_waiting(live=self._source.is_live, reading=self._source.is_reading)
        self._show_episodes()
        self._panel.show_processes(self._title(), conditions(self.history.said, at_ns, live))

    def _title(self) -> str:
        return self._source.title if self._beside is None else f"{self._source.title}, beside it {self._beside.title}"

    def _choose(self) -> None:
        """Choose the episode to show: the newest of a live run, until a user chooses another one."""
        episodes = self.history.episodes
        if not episodes:
            return
        newest = next(reversed(episodes.values()) if self._source.is_live else iter(episodes.values()))
        if self.shown is None or (self._follows_newest and self._source.is_live and newest is not self.shown):
            self._begin(newest)

    def _show_episodes(self) -> None:
        """List the episodes that a user can choose."""
        episodes, indices = self.history.episodes, self.history.indices
        if self.shown is not None:
            labels = {key: f"{indices[key]}: simulator {key[0]}" for key in episodes}
            chosen = next(label for key, label in labels.items() if episodes[key] is self.shown)
            self._panel.show_episodes(tuple(labels.values()), chosen)

    def _begin(self, timeline: Timeline) -> None:
        """Show another episode from its beginning."""
        self.shown = self.history.held = timeline
        self.player.restart()
        self._scene.begin(timeline)
        self._scene.show(self.history, timeline, self.player.row(timeline), follow=self._follows_robot)

    def obey(self, command: PanelCommand) -> None:
        """Carry out the command of a user."""
        if command.name in LAYERS:
            for scene in (self._scene, *([] if self._beside is None else [self._beside.scene])):
                scene.show_layer(command.name, bool(command.value))
        elif command.name == FOLLOW_ROBOT:
            self._follows_robot = bool(command.value)
        elif command.name == "camera":
            self._aim(command)
        elif command.name == "speed":
            self.player.speed = speed_of(command.value)
        elif self.shown is not None:
            self._obey_in_time(command, self.shown)

    def _obey_in_time(self, command: PanelCommand, timeline: Timeline) -> None:
        """Carry out a command that moves the player, or chooses the episode.

        Raises:
            ConfigError: There is no such command.
        """
        player = self.player
        self._follows_newest = False
        match command.name:
            case "seek":
                player.seek(float(command.value), timeline)
            case "play":
                act: Callable[[], None] = player.pause if player.is_playing else lambda: player.play(timeline)
                act()
            case "live":
                self._follows_newest = True
                player.follow()
            case "jump":
                n = -1 if "<" in command.value else 1
                (player.move_steps if "|" in command.value else player.move_rows)(n, timeline)
            case "episode":
                self._begin_chosen(int(str(command.value).partition(":")[0]))
            case _:
                raise ConfigError(f"Expected a command of the page, got {command.name}")

    def _begin_chosen(self, index: int) -> None:
        """Show an episode that a user chose, unless it has been forgotten meanwhile."""
        for key, each in self.history.indices.items():
            if each == index:
                self._begin(self.history.episodes[key])
                if self.player.follows:
                    self.player.play(self.history.episodes[key])

    def _aim_at_both(self) -> None:
        """Aim the camera of those who open the page from now on at both rooms."""
        camera = CAMERAS["Room"]
        self._server.initial_camera.position = self._on_page(camera.position_m, camera)
        self._server.initial_camera.look_at = self._on_page(camera.look_at_m, camera)

    def _aim(self, command: PanelCommand) -> None:
        """Aim the camera of the user who asked for it."""
        client = command.client
        if client is None:
            return
        camera = CAMERAS[str(command.value)]
        with client.atomic():
            client.camera.position = self._on_page(camera.position_m, camera)
            client.camera.look_at = self._on_page(camera.look_at_m, camera)

    def _on_page(self, point_m: tuple[float, float, float], camera: Viewpoint) -> tuple[float, float, float]:
        """Convert a point from the frame of a camera, on the floor, to that of the page."""
        if self.shown is None:
            return point_m
        qpos = self.shown.qpos[self.player.row(self.shown)]
        x, y, z = point_m
        if camera.of == "room":
            width_m, depth_m = self.shown.scenario.room.size_m
            width_m = width_m if self._beside is None else 2 * width_m + GAP_M
            side_m, yaw, place = max(width_m, depth_m), 0.0, np.array([width_m, depth_m]) / 2
            x, y, z = side_m * x, side_m * y, side_m * z
        else:
            pose = qpos[TRUNK if camera.of == "robot" else BOX]
            yaw, place = float(rpy_from_quaternion(pose[3:])[2]), pose[:2]
        moved = qpos[TRUNK][:2] if self._follows_robot else np.zeros(2)
        away_x, away_y = (place - moved).tolist()
        return away_x + cos(yaw) * x - sin(yaw) * y, away_y + sin(yaw) * x + cos(yaw) * y, z
