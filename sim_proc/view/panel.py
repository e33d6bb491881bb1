"""The controls of the page: the processes and what they do, the moment that is shown, and which layers are visible."""

from collections.abc import Callable, Coroutine, Sequence
from dataclasses import dataclass, field
from html import escape
from math import isfinite
from queue import Empty, SimpleQueue
from typing import Any, Final, Literal

import viser

from legpush.history.timeline import Timeline
from legpush.messages.stepping import Push, Walk
from sim_proc.scene_3d.scene import LAYERS
from sim_proc.view.player import SPEEDS, Player
from sim_proc.view.statuses import Condition

FOLLOW_ROBOT: Final = "follow the robot"
COLORS: Final = {"alive": "#1fa35c", "silent": "#e0a100", "gone": "#b9bec7"}
WORDS: Final = {"planner": "Planner", "sim": "Simulator", "agent": "Agent"}
ROW: Final = "display:flex;gap:.5em;align-items:baseline;padding:.12em 0"
SMALL: Final = "color:#6b7280;font-size:.85em"


@dataclass(frozen=True)
class Viewpoint:
    """Position of a camera, and the point that it looks at, in the frame of robot, box or room.

    The frame of the room is at its middle, and its lengths are in the longer side of the room.
    """

    position_m: tuple[float, float, float]
    look_at_m: tuple[float, float, float]
    of: Literal["robot", "box", "room"] = "robot"


CAMERAS: Final = {
    "Behind": Viewpoint((-2.2, -1.4, 1.4), (0.5, 0.0, 0.1)),
    "Side": Viewpoint((0.4, -2.6, 0.9), (0.4, 0.0, 0.2)),
    "Top": Viewpoint((-0.05, 0.0, 6.0), (0.0, 0.0, 0.0)),
    "Box": Viewpoint((-0.3, -1.5, 0.9), (0.0, 0.0, 0.1), "box"),
    "Room": Viewpoint((0.0, -0.9, 1.2), (0.0, 0.0, 0.0), "room"),
}
PREVIOUS_STEP, PREVIOUS_TICK, NEXT_TICK, NEXT_STEP = JUMPS = ("|<", "<", ">", ">|")
"""Buttons that move by a step of the lockstep or by a tick."""
KEYS: Final[dict[tuple[Any, Any], tuple[str, str, str | None]]] = {
    ("space", None): ("Play or pause", "play", None),
    ("arrowleft", None): ("Previous tick", "jump", PREVIOUS_TICK),
    ("arrowright", None): ("Next tick", "jump", NEXT_TICK),
    ("arrowleft", "shift"): ("Previous step", "jump", PREVIOUS_STEP),
    ("arrowright", "shift"): ("Next step", "jump", NEXT_STEP),
    **{(str(n), None): (f"Camera: {name}", "camera", name) for n, name in enumerate(CAMERAS, start=1)},
}
"""What keys do, with or without Shift: a label, and the name and the value of a command."""
NOTICES: Final = """<style>
.mantine-Notifications-root[data-position^="top"] { top: auto !important; bottom: 1em !important; }
</style>"""
"""viser's notices, such as that there is no GPU, stand below the scene instead of over it."""


@dataclass(frozen=True)
class PanelCommand:
    """A command that a user gave."""

    name: str
    value: Any = None
    client: viser.ClientHandle | None = field(default=None, compare=False)


class Panel:
    """The main panel of the page, and the commands that users gave there."""

    def __init__(self, server: viser.ViserServer, *, live: bool) -> None:
        """Create all controls. Only a live run has a button to follow it."""
        self._commands: SimpleQueue[PanelCommand] = SimpleQueue()
        self._gui = gui = server.gui
        gui.add_html(NOTICES)
        self._processes = gui.add_html("")
        self._now = gui.add_html("")
        self._shown: dict[int, str] = {}
        with gui.add_folder("Time"):
            self._episode: Any = gui.add_dropdown("Episode", ("-",), visible=False)
            self._on_update(self._episode, "episode")
            self._slider: Any = gui.add_slider("Time [s]", min=0.0, max=1.0, step=0.02, initial_value=0.0)
            self._on_update(self._slider, "seek")
            self._play = gui.add_button("Pause", icon=viser.Icon.PLAYER_PAUSE)
            self._on_click(self._play, "play")
            self._live = gui.add_button("Follow live", icon=viser.Icon.LIVE_PHOTO, color="red", visible=live)
            self._on_click(self._live, "live")
            self._jump = gui.add_button_group("Step", JUMPS)
            self._on_click(self._jump, "jump")
            self._speed = gui.add_dropdown("Speed", tuple(map(speed_label, SPEEDS)), initial_value=speed_label(1.0))
            self._on_update(self._speed, "speed")
        with gui.add_folder("Show"):
            self._camera = gui.add_button_group("Camera", tuple(CAMERAS))
            self._on_click(self._camera, "camera")
            self._on_update(gui.add_checkbox("Follow robot", initial_value=True), FOLLOW_ROBOT)
            for name, label in LAYERS.items():
                self._on_update(gui.add_checkbox(label, initial_value=True), name)
        for (key, modifier), (label, name, value) in KEYS.items():
            self._on_key(gui.add_command(label, hotkey=key, modifier=modifier), name, value)

    def commands(self) -> list[PanelCommand]:
        """Commands that users gave since the last call, in order."""
        done = []
        while True:
            try:
                done.append(self._commands.get_nowait())
            except Empty:
                return done

    def show_processes(self, title: str, conditions: Sequence[Condition]) -> None:
        """Show what each process does, and which peer it waits for."""
        rows = "".join(map(_process_row, conditions))
        self._set(self._processes, f"<div style='padding:.4em .8em 0'><b>{escape(title)}</b>{rows}</div>")

    def show_episodes(self, labels: tuple[str, ...], chosen: str) -> None:
        """List the episodes, and mark the chosen one."""
        if labels != self._episode.options:
            self._episode.options = labels
            self._episode.visible = len(labels) > 1
        if self._episode.value != chosen:
            self._episode.value = chosen

    def show_time(self, timeline: Timeline, row: int, player: Player) -> None:
        """Show the moment of a row, and whether the player moves."""
        last_s = max(0.02, round(float(timeline.time_s[-1]), 2))
        if self._slider.max != last_s:
            self._slider.max = last_s
        time_s = round(float(timeline.time_s[row]), 2)
        if self._slider.value != time_s:
            self._slider.value = time_s
        label = "Pause" if player.is_playing else "Play"
        if self._play.label != label:
            self._play.label = label
            self._play.icon = viser.Icon.PLAYER_PAUSE if player.is_playing else viser.Icon.PLAYER_PLAY
        if self._live.disabled != player.follows:
            self._live.disabled = player.follows
        self._set(self._now, now_html(timeline, row))

    def show_waiting(self, *, live: bool, reading: bool) -> None:
        """Say that there is nothing to see yet, or at all."""
        text = "Nothing has moved yet. <code>legpush run</code> in a terminal begins a run."
        if not live:
            text = "Reading." if reading else "It has no episode whose beginning or scenario was recorded."
        self._set(self._now, f"<div style='padding:.2em .8em;{SMALL}'>{text}</div>")

    def _set(self, handle: Any, content: str) -> None:
        """Set the content of a control if it has changed."""
        if self._shown.get(id(handle)) != content:
            self._shown[id(handle)] = content
            handle.content = content

    def _on_update(self, handle: Any, name: str) -> None:
        self._listen(handle.on_update, name)

    def _on_click(self, handle: Any, name: str) -> None:
        self._listen(handle.on_click, name)

    def _on_key(self, handle: viser.CommandHandle, name: str, value: str | None) -> None:
        async def take(event: Any) -> None:
            if event.client_id is not None:
                self._commands.put(PanelCommand(name, value, event.client))

        handle.on_trigger(take)

    def _listen(self, register: Callable[[Callable[[Any], Coroutine[Any, Any, None]]], object], name: str) -> None:
        """Queue a command for each event of a control."""

        # Viser awaits a coroutine at once, but runs a function in another thread. By then the control may have been set
        # to the present time again, and the choice of the user would be lost.
        async def take(event: Any) -> None:
            # Ignore values that this program set itself, and values that the control does not offer.
            if event.client_id is not None and is_possible(event.target):
                self._commands.put(PanelCommand(name, event.target.value, event.client))

        register(take)


def is_possible(handle: Any) -> bool:
    """Whether the value of a control is one that it offers. Anyone who reaches the port can send other values."""
    options = getattr(handle, "options", None)
    if options is not None:
        return handle.value in options
    return isinstance(handle.value, bool) or (isinstance(handle.value, int | float) and isfinite(handle.value))


def speed_label(speed: float) -> str:
    """A speed, for people."""
    return f"{speed:g} x"


def speed_of(label: str) -> float:
    """The speed of a label that `speed_label` made."""
    return float(label.removesuffix(" x"))


def now_html(timeline: Timeline, row: int) -> str:
    """The motion at a row, the error of the box, and the reward."""
    step = timeline.step_at(row)
    error_m, angle_rad = timeline.box_error(slice(row, row + 1))[0]
    lines = [
        ("step", f"{step.number}: {_motion(step.motion)}"),
        ("box error", f"{100 * error_m:.1f} cm, {57.29578 * angle_rad:.1f}&deg;"),
    ]
    if step.number in timeline.rewards:
        lines.append(("reward", f"{timeline.rewards[step.number]:+.2f}"))
    if step.world.fallen and row == step.first_row + step.n_rows - 1:
        lines.append(("robot", "<b style='color:#c0392b'>fell</b>"))
    rows = "".join(
        f"<div style='{ROW}'><span style='{SMALL};min-width:5em'>{name}</span><span>{value}</span></div>"
        for name, value in lines
    )
    return f"<div style='padding:0 .8em .2em'>{rows}</div>"


def _motion(motion: object) -> str:
    if isinstance(motion, Push):
        depth = f"{100 * motion.depth_m:.1f} cm deep"
        return f"push {motion.leg}, {motion.face} face, w {motion.w1:.2f} {motion.w2:.2f}, {depth}"
    return "walk" if isinstance(motion, Walk) else type(motion).__name__.lower()


def _process_row(condition: Condition) -> str:
    name = WORDS[condition.role] + ("" if condition.name == "main" else f" {condition.name}")
    said = " ".join(filter(None, (condition.phase, condition.detail)))
    if condition.health == "gone":
        said = "not there" if not said else f"gone; last: {said}"
    elif not said:
        said = "there, but silent"
    waiting = f" &middot; <b style='color:#b45309'>waits for {escape(condition.waiting_for)}</b>"
    return (
        f"<div style='{ROW}' data-process='{condition.role}' data-health='{condition.health}'>"
        f"<span style='color:{COLORS[condition.health]}'>&#9679;</span>"
        f"<span style='min-width:5.4em'>{escape(name)}</span>"
        f"<span style='{SMALL}'>{escape(said)}{waiting if condition.waiting_for else ''}</span></div>"
    )
