"""A small scenario, as a file says it, and edits that spoil it."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import tomli_w

Plain = dict[str, Any]


def plain_scenario() -> Plain:
    """A small valid scenario as a file says it: a wall at x 4.0 to 4.2 between the start and the box."""
    return {
        "name": "small",
        "room": {
            "size_m": [8.0, 5.0],
            "obstacles": [{"x_min_m": 3.0, "x_max_m": 3.2, "y_min_m": 0.0, "y_max_m": 2.0}],
        },
        "start": {"x_m": 1.0, "y_m": 1.0, "yaw_deg": 0.0},
        "box": {"pose": {"x_m": 5.5, "y_m": 2.5, "yaw_deg": 0.0}},
        "goal": {"pose": {"x_m": 6.5, "y_m": 2.5, "yaw_deg": 0.0}},
    }


def write(folder: Path, plain: Plain) -> Path:
    path = folder / "small.toml"
    path.write_text(tomli_w.dumps(plain))
    return path


def put(*place: str | int, value: Any) -> Callable[[Plain], None]:
    """An edit that sets the value at a path of keys and indices."""

    def edit(plain: Plain) -> None:
        node: Any = plain
        for step in place[:-1]:
            node = node[step] if isinstance(step, int) else node.setdefault(step, {})
        node[place[-1]] = value

    return edit


def rear_only(edit: Callable[[Plain], None]) -> Callable[[Plain], None]:
    """The same, and no face but the rear one may be pushed."""

    def edits(plain: Plain) -> None:
        edit(plain)
        put("pushing", "faces", value=["rear"])(plain)

    return edits


def drop(table: str, field: str) -> Callable[[Plain], None]:
    def edit(plain: Plain) -> None:
        del plain[table][field]

    return edit
