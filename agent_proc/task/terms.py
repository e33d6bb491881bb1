"""The terms that tasks may name, and how they are made from the tables of a task."""

from collections.abc import Mapping
from typing import Any, Final, TypeVar

import msgspec

from agent_proc.task.ending.aborts import Astray
from agent_proc.task.ending.arrivals import NoPushHelps, PastGoal, Release, Tolerance
from agent_proc.task.observation.box import BoxSides, LostDepth, PushDrift, PushEffect
from agent_proc.task.observation.goal_frame import BoxPlace, BoxPlaceNear, BoxYaw, Heading, HeadingNear
from agent_proc.task.observation.world_frame import Body, BoxCorner, FootForces, GoalCorner, Tip
from agent_proc.task.reward.corners import AngleError, CornerDistance, CornersWithin
from agent_proc.task.reward.progress import (
    Cycle,
    Fall,
    GoalProgress,
    PositionProgress,
    Precision,
    SteeringProgress,
    Success,
    Time,
)
from agent_proc.task.term import AbortTerm, ArrivalTerm, ObservationTerm, RewardTerm
from legpush.errors import ConfigError, MessageError
from legpush.messages.codec import convert
from legpush.plugins import Group, load_plugin, plugin_names
from legpush.schema_errors import explain

GROUP: Final[Group] = "legpush.tasks"
"""Entry points of terms of other packages."""
TERM: Final = "term"
"""Key of a table that names its term, where the name of the table is another one."""

PARTS: Final = ("observation", "reward", "ending")
"""Fields of a task that have tables of terms."""

AnyTerm = ObservationTerm | RewardTerm | ArrivalTerm | AbortTerm
Kind = TypeVar("Kind", bound=AnyTerm)
Table = dict[str, Any]
Tables = dict[str, Table]
"""Settings of terms by the name that each has in its task."""

OBSERVATION: Final[dict[str, type[ObservationTerm]]] = {
    "body": Body,
    "box_corner": BoxCorner,
    "tip": Tip,
    "foot_forces": FootForces,
    "goal_corner": GoalCorner,
    "box": BoxPlace,
    "box_near": BoxPlaceNear,
    "yaw": BoxYaw,
    "heading": Heading,
    "heading_near": HeadingNear,
    "box_sides": BoxSides,
    "lost_depth": LostDepth,
    "drift": PushDrift,
    "effect": PushEffect,
}
REWARD: Final[dict[str, type[RewardTerm]]] = {
    "corner_distance": CornerDistance,
    "angle_error": AngleError,
    "corners_within": CornersWithin,
    "position_progress": PositionProgress,
    "steering_progress": SteeringProgress,
    "goal_progress": GoalProgress,
    "cycle": Cycle,
    "time": Time,
    "success": Success,
    "precision": Precision,
    "fall": Fall,
}
ENDING: Final[dict[str, type[ArrivalTerm | AbortTerm]]] = {
    "tolerance": Tolerance,
    "past_goal": PastGoal,
    "no_push_helps": NoPushHelps,
    "release": Release,
    "astray": Astray,
}
OWN: Final[dict[str, type[AnyTerm]]] = {**OBSERVATION, **REWARD, **ENDING}
"""Terms of this package."""


def make_terms(tables: Mapping[str, Table], kinds: tuple[type[Kind], ...], where: str) -> dict[str, Kind]:
    """Make the terms of the tables at `where`, such as `reward`, in their order.

    Raises:
        ConfigError: There is no such term, it is of another kind, or a setting is wrong; names table and setting.
        PluginError: A term of another package cannot be imported.
    """
    return {name: _make(table, name, kinds, f"{where}.{name}") for name, table in tables.items()}


def complete(tables: Mapping[str, Table], kinds: tuple[type[Kind], ...], where: str) -> Tables:
    """The same tables with every setting that was left out, so that they mean the same when a default changes.

    Raises:
        ConfigError: As `make_terms`.
        PluginError: As `make_terms`.
    """
    terms = make_terms(tables, kinds, where)
    return {
        name: {TERM: tables[name].get(TERM, name), **msgspec.json.decode(msgspec.json.encode(terms[name]))}
        for name in terms
    }


def foreign_terms(task: Mapping[str, Any]) -> tuple[str, ...]:
    """Names of the terms of other packages in the table of a task; nothing is imported to find them.

    The table may be anything that was read; what is no table of terms has none.
    """
    parts = [part for part in map(task.get, PARTS) if isinstance(part, dict)]
    tables = [(name, table) for part in parts for name, table in part.items() if isinstance(table, dict)]
    return tuple(sorted({str(table.get(TERM, name)) for name, table in tables} - OWN.keys()))


def _make(table: Table, name: str, kinds: tuple[type[Kind], ...], where: str) -> Kind:
    term = table.get(TERM, name)
    if not isinstance(term, str):
        raise ConfigError(f"at `{where}.{TERM}`: expected the name of a term, got {term!r}")
    found = _find(term, kinds, where)
    settings = {key: value for key, value in table.items() if key != TERM}
    try:
        return convert(settings, found)
    except MessageError as error:
        raise ConfigError(explain(str(error), settings, found, at=where)) from error


def _find(term: str, kinds: tuple[type[Kind], ...], where: str) -> type[Kind]:
    if term not in OWN and term not in (plugins := plugin_names(GROUP)):
        names = ", ".join(name for name, kind in OWN.items() if issubclass(kind, kinds))
        also = f"; of other packages: {', '.join(plugins)}" if plugins else ""
        raise ConfigError(f"at `{where}`: expected one of the terms {names}{also}, got {term!r}")
    found = OWN.get(term) or load_plugin(GROUP, term)
    if not (isinstance(found, type) and issubclass(found, kinds)):
        expected = " or ".join(kind.__name__ for kind in kinds)
        raise ConfigError(f"at `{where}`: expected a term of the kind {expected}, got {term!r}, which is another kind")
    return found
